#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Commands that show one object of a server. Each prints for people, or one JSON document with
/// `json`, and returns an exit code.
namespace kinship::cli {

int show_status(link::Client& server, bool json, std::ostream& out, std::ostream& err);

/// \param name  a label, or the beginning of a digest.
int show_robot(link::Client& server, const std::string& name, bool json, std::ostream& out,
               std::ostream& err);
int show_task(link::Client& server, const std::string& task, bool json, std::ostream& out,
              std::ostream& err);
/// \param id  a report UUID.
int show_path(link::Client& server, const std::string& id, bool json, std::ostream& out,
              std::ostream& err);
/// Also an attempt that is not solved: why not. \param id  a report UUID.
int show_attempt(link::Client& server, const std::string& id, bool json, std::ostream& out,
                 std::ostream& err);
/// \param id  the beginning of a distribution's id.
int show_distribution(link::Client& server, const std::string& id, bool json, std::ostream& out,
                      std::ostream& err);

struct ExperienceOptions {
  std::string task;
  std::uint32_t max_bytes = kDefaultExperienceBytes;
  bool json = false;
};

/// `tasks experience`: the ways of a task that planners receive, each with its robot, report, start
/// and end.
/// \return kNotFound if the task has none.
int show_experience(link::Client& server, const ExperienceOptions& options, std::ostream& out,
                    std::ostream& err);

}  // namespace kinship::cli
