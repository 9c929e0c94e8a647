#pragma once

#include <string>

#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/distribution_store.hpp"
#include "server/store/robot_store.hpp"

/// Look-ups by the names that people use.
namespace kinship::service {

/// By label or by a digest prefix of at least four digits; reads no description.
/// \return NotFound, or Conflict that names two candidates.
Result<RobotSummary> find_robot(const store::RobotStore& store, const std::string& name);

/// By an id prefix of at least four digits.
/// \return NotFound, InvalidInput for an invalid prefix, or Conflict that names two candidates. A
///         whole id is returned even if no distribution has it.
Result<Digest> find_distribution_id(const store::DistributionStore& store, const std::string& name);

/// \throws Failure(InvalidInput) for an invalid UUID.
Uuid report_of(const std::string& text);

/// "no task 'bin'"
Error not_found(const std::string& what, const std::string& name);

}  // namespace kinship::service
