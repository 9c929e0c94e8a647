#pragma once

#include <filesystem>

/// Where the files are that are installed with a program.
namespace kinship::files {

/// The file of the running program.
std::filesystem::path own_program();

/// \param name         below share/kinship, e.g. "schemas".
/// \param in_sources   for programs that are not installed.
/// \return ../share/kinship/NAME from the folder of the running program if it is there: the
///         installation may be moved; else `in_sources`.
std::filesystem::path installed_place(const std::filesystem::path& name,
                                      const std::filesystem::path& in_sources);

}  // namespace kinship::files
