#pragma once

#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// The rows of the admin verbs that explain, take out, evict or go on for long: the server writes
/// them, the command line reads them. Member names are those of the structs and stay.
namespace kinship::json {

std::string to_json(const Explanation& explanation);
std::string to_json(const Retirement& retirement);
std::string to_json(const RobotRemoval& removal);
std::string to_json(const Job& job);
std::string to_json(const AuditEntry& entry);

/// The row of EvictDistribution, `{"evicted": id}`.
std::string eviction_to_json(const Digest& distribution_id);

/// The mixture of the distribution may be missing (weights, means and covariances null).
Result<Explanation> explanation_from_json(std::string_view text);
Result<Retirement> retirement_from_json(std::string_view text);
Result<RobotRemoval> robot_removal_from_json(std::string_view text);
Result<Job> job_from_json(std::string_view text);
Result<AuditEntry> audit_entry_from_json(std::string_view text);
Result<Digest> eviction_from_json(std::string_view text);  ///< \return the distribution's id

}  // namespace kinship::json
