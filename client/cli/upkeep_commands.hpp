#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Commands that rename and remove robots, exclude experience from fits, and drop mixtures.
namespace kinship::cli {

/// `paths retire`: excludes a path from every fit; it stays for the record.
/// \param id         a report UUID, or its first eight digits or more.
/// \param confirmed  false: prints the effect and returns kWrongUsage.
int retire_path(link::Client& server, const std::string& id, bool confirmed, bool json,
                std::ostream& out, std::ostream& err);

struct RestoreOptions {
  std::string id;           ///< of one path; empty: of a task and robot
  std::string task, robot;  ///< each empty for all, not both
  bool json = false;
};

/// `paths restore`: undoes retirements; each path is stored anew under a UUID of its own.
/// \return kNotFound if nothing was to be restored, kFailed if some could not be.
int restore_paths(link::Client& server, const RestoreOptions& options, std::ostream& out,
                  std::ostream& err);

/// `tasks reset`: retires all paths of a task.
/// \param confirmed  false: prints the effect and returns kWrongUsage; kDone if there is no effect.
int reset_task(link::Client& server, const std::string& task, bool confirmed, bool json,
               std::ostream& out, std::ostream& err);

/// `tasks rename`: another name for a task, which no other task has.
int rename_task(link::Client& server, const std::string& task, const std::string& name, bool json,
                std::ostream& out, std::ostream& err);

/// `tasks remove`: retires all paths of a task, deletes its distributions and lists it no more.
/// \param confirmed  false: prints the effect and returns kWrongUsage.
int remove_task(link::Client& server, const std::string& task, bool confirmed, bool json,
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
