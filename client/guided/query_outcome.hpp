#pragma once

#include <optional>
#include <string>

#include "client/guided/planner_choice.hpp"
#include "client/guided/query_sampler.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/not_planned.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/no_path.hpp"

/// The words and codes of a result that follow from a query and from how its search ended.
namespace kinship::guided {

/// Empty for a query that is to be guided.
std::string why_unguided(const QueryGuidance& query);

/// Which planner answers: a roadmap leaves a mixture of too many components to its trees.
std::string planner_text(const PlannerChoice& planner,
                         const planning::ConfigurationSampler& sampler);

Outcome outcome_of(const planning::PlanSummary& summary);

/// Why no search was begun; empty for reasons that end a search.
std::optional<NotPlanned> not_planned_by(planning::NoPath reason);

}  // namespace kinship::guided
