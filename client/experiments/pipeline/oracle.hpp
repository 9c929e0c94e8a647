#pragma once

#include <optional>

#include "client/experiments/pipeline/fleet.hpp"
#include "client/guided/plan_settings.hpp"
#include "client/guided/query_sampler.hpp"
#include "proto/types/problem.hpp"

namespace kinship::experiments {

/// The guidance that nobody can have: kernels around a shortened path that solves this very query,
/// found by uniform planning with the same goals. What it is worth bounds what samples can be worth
/// in the same planner. \param deviation  of each joint about the path, joint units. \return
/// nothing if the query was not solved; what finding the path cost is not told.
std::optional<guided::Guidance> oracle_guidance(const StudyMember& member, const Problem& problem,
                                                const guided::PlanSettings& settings,
                                                double deviation);

}  // namespace kinship::experiments
