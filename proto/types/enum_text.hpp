#pragma once

#include <string_view>

#include "proto/types/attempt.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/publications.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// The words for enumerators wherever people or files see them: lower case, stable.
namespace kinship {

std::string_view to_text(Outcome outcome);          ///< solved, timeout, failed
std::string_view to_text(Arm arm);                  ///< guided, control, uniform
std::string_view to_text(DistributionState state);  ///< ready, failed, thin
std::string_view to_text(Relation relation);        ///< other, same_arm, identical
std::string_view to_text(Weighting weighting);      ///< sources, paths
std::string_view to_text(EventKind kind);  ///< registered, report, fetch, fit, refusal, admin
std::string_view to_text(JobState state);  ///< queued, running, done, failed, cancelled

/// Each returns the enumerator, or InvalidInput that lists the allowed words.
Result<Outcome> parse_outcome(std::string_view text);
Result<Arm> parse_arm(std::string_view text);
Result<DistributionState> parse_distribution_state(std::string_view text);
Result<Relation> parse_relation(std::string_view text);
Result<Weighting> parse_weighting(std::string_view text);
Result<JobState> parse_job_state(std::string_view text);

}  // namespace kinship
