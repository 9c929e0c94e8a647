#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Programs in Debian's Python, whose packages are what Kinship is tested with.
namespace kinship::experiments {

/// The folder of the programs in Python, in the sources.
std::filesystem::path python_folder();

/// Runs a program in place of this one.
/// \throws Failure(NotFound) without the program or Python.
[[noreturn]] void become_python(const std::filesystem::path& program,
                                const std::vector<std::string>& arguments);

/// What a program writes. Its messages go where those of this one go.
/// \throws Failure(NotFound) likewise, and if it says so; Failure(InvalidInput) if it fails.
std::string output_of_python(const std::filesystem::path& program,
                             const std::vector<std::string>& arguments);

}  // namespace kinship::experiments
