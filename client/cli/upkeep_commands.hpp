#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Commands that rename and remove robots, exclude experience from fits, and drop mixtures.
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

/// `robots rename`: another label for a robot; its old label becomes free.
/// \param robot  its label or the beginning of its digest.
int rename_robot(link::Client& server, const std::string& robot, const std::string& label,
                 bool json, std::ostream& out, std::ostream& err);

/// `robots remove`: deletes a robot without attempts; otherwise retires its paths.
/// \param confirmed  false: prints the effect and returns kWrongUsage.
int remove_robot(link::Client& server, const std::string& robot, bool confirmed, bool json,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
