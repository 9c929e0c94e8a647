#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/distribution_store.hpp"
#include "server/store/experience_store.hpp"
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

/// The report of a UUID, or of a prefix of at least eight digits; a whole UUID is returned even if
/// no report has it.
/// \throws Failure(InvalidInput) for an invalid or ambiguous prefix; Failure(NotFound).
Uuid report_of(const store::ExperienceStore& store, const std::string& text);

/// Reports whose UUIDs begin with a text of at least eight digits, in order, at most `limit`.
/// \throws Failure(InvalidInput) for another text.
std::vector<Uuid> reports_like(const store::ExperienceStore& store, const std::string& text,
                               std::size_t limit);

/// "no task 'lod' (did you mean 'load'?)", with the nearest of all tasks.
Error no_task(const store::ExperienceStore& store, const std::string& task);

/// "no report 'bin'"
Error not_found(const std::string& what, const std::string& name);

}  // namespace kinship::service
