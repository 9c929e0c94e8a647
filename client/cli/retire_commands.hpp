#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Commands that take something out of what is made from experience.
namespace kinship::cli {

/// `paths retire`: out of every fit, kept for the record.
/// \param id  a report UUID.
int retire_path(link::Client& server, const std::string& id, bool json, std::ostream& out,
                std::ostream& err);

/// `tasks reset`: retires all paths of a task.
/// \param confirmed  false: says what would happen and returns kWrongUsage; kDone if that is
/// nothing.
int reset_task(link::Client& server, const std::string& task, bool confirmed, bool json,
               std::ostream& out, std::ostream& err);

/// `distributions evict`: forgets a mixture; the next fetch has it made anew.
/// \param id  the beginning of a distribution's id.
int evict_distribution(link::Client& server, const std::string& id, bool json, std::ostream& out,
                       std::ostream& err);

}  // namespace kinship::cli
