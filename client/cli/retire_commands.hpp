#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Commands that exclude experience from fits, or drop mixtures.
namespace kinship::cli {

/// `paths retire`: excludes a path from every fit; it stays for the record.
/// \param id  a report UUID.
int retire_path(link::Client& server, const std::string& id, bool json, std::ostream& out,
                std::ostream& err);

/// `tasks reset`: retires all paths of a task.
/// \param confirmed  false: prints the effect and returns kWrongUsage; kDone if there is no effect.
int reset_task(link::Client& server, const std::string& task, bool confirmed, bool json,
               std::ostream& out, std::ostream& err);

/// `distributions evict`: drops a mixture; the next fetch makes it again.
/// \param id  the beginning of a distribution's id.
int evict_distribution(link::Client& server, const std::string& id, bool json, std::ostream& out,
                       std::ostream& err);

}  // namespace kinship::cli
