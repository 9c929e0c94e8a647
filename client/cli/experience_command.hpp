#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

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
