#pragma once

#include <string>

#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/store.hpp"

/// Things as people name them.
namespace kinship::service {

/// By label or by a digest prefix of at least four digits; reads no description.
/// \return NotFound, or Conflict that names two candidates.
Result<RobotSummary> find_robot(const store::Store& store, const std::string& name);

/// By an id prefix of at least four digits.
/// \return NotFound, InvalidInput for what is no prefix, or Conflict that names two candidates.
///         A whole id is returned also if there is no such distribution.
Result<Digest> find_distribution_id(const store::Store& store, const std::string& name);

/// \throws Failure(InvalidInput) for what is no UUID.
Uuid report_of(const std::string& text);

/// "no task 'bin'"
Error not_found(const std::string& what, const std::string& name);

}  // namespace kinship::service
