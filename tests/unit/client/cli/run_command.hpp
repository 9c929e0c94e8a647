#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "client/cli/commands.hpp"

namespace kinship::cli {

struct Answer {
  int code = -1;
  std::string out, err;
};

/// A command line of `kinship`, run in this process.
inline Answer run_command(const std::vector<std::string>& arguments) {
  std::vector<const char*> argv = {"kinship"};
  for (const std::string& argument : arguments)
    argv.push_back(argument.c_str());
  std::ostringstream out;
  std::ostringstream err;
  const int code = run(static_cast<int>(argv.size()), argv.data(), out, err);
  return {code, out.str(), err.str()};
}

}  // namespace kinship::cli
