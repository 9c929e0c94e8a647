#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kinship::experiments {

/// The folder of the programs in Python, in the sources.
std::filesystem::path python_folder();

/// Runs a program in Debian's Python in place of this one: its packages are what Kinship is tested
/// with.
/// \throws Failure(NotFound) without the program or Python.
[[noreturn]] void become_python(const std::filesystem::path& program,
                                std::vector<std::string> arguments);

}  // namespace kinship::experiments
