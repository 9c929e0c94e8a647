#pragma once

#include <string>
#include <vector>

#include "tests/support/server_process.hpp"

namespace kinship::test {

/// A program from anywhere, by its path and arguments.
class ChildProcess : public Program {
 public:
  explicit ChildProcess(const std::vector<std::string>& command)
      : Program(command.at(0), {command.begin() + 1, command.end()}) {}
};

}  // namespace kinship::test
