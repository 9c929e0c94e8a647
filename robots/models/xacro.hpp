#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kinship::models {

/// What `xacro` needs beside a file.
struct XacroInput {
  std::vector<std::string> arguments;  ///< "NAME:=VALUE" each
  std::size_t max_bytes = 0;           ///< of the file, and of what is made of it
  std::string_view ending;             ///< of an expanded file, ".urdf" or ".srdf"
};

/// The text of a URDF or SRDF file. One that is xacro (xacro_mark) is expanded by the program
/// `xacro` of ROS, as found in PATH, which runs other files that it names.
/// \throws Failure of read_text(); InvalidInput with the mark and how to expand the file if there
///         is no such program, with the program's own message if it fails, and for an argument
///         that is not NAME:=VALUE.
std::string read_expanded(const std::filesystem::path& file, const XacroInput& input);

}  // namespace kinship::models
