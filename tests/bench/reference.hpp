#pragma once

#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"

/// Programs that do the same with another library, so that both are measured in one run.
namespace kinship::bench {

/// Whether references from deploy/packages-bench.txt are wanted: all that every benchmark takes
/// from its command line.
inline bool wants_references(int argc, char** argv) {
  return std::find(argv + 1, argv + argc, std::string("--no-references")) == argv + argc;
}

/// A program of this build, for ChildProcess.
inline std::string beside_this_program(const std::string& name) {
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename(name).string();
}

/// Runs a reference on one thread and reads the numbers that it prints in its only line.
/// \throws std::runtime_error if it cannot be run, or prints something else.
inline std::vector<double> run_reference(std::vector<std::string> command, std::size_t numbers) {
  const std::string name =
      command.size() > 1 && command[0] == "/usr/bin/python3" ? command[1] : command[0];
  command.insert(command.begin(), {"/usr/bin/env", "OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1"});
  test::ChildProcess process(command);
  std::istringstream line(process.read_line());
  std::vector<double> values;
  for (double value = 0; line >> value;)
    values.push_back(value);
  if (process.wait() != 0 || values.size() != numbers)
    throw std::runtime_error(name +
                             ": no result; is deploy/packages-bench.txt installed? "
                             "--no-references goes without");
  return values;
}

}  // namespace kinship::bench
