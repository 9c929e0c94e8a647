#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::models {

/// The whole text of a file of at most `max_bytes`.
/// \throws Failure(NotFound, InvalidInput or TooLarge) that names the file.
std::string read_text(const std::filesystem::path& file, std::size_t max_bytes);

/// The first mark of a text as unexpanded xacro: an element `xacro:...`, or `${...}`, `$(find
/// ...)`, `$(arg ...)` in an attribute of an element of the model; as text with its line. Empty for
/// other texts, or no XML. Settings of plugins (`<gazebo>`, `<ros2_control>`) do not count, nor
/// does a mere declaration xmlns:xacro, which expanded files keep.
std::string xacro_mark(std::string_view text);

/// The error for a file whose text is xacro where there is no program to expand it: its mark, and
/// how to expand it.
/// \param ending  of the expanded file, ".urdf" or ".srdf".
std::optional<Error> check_expanded(const std::filesystem::path& file, std::string_view text,
                                    std::string_view ending);

}  // namespace kinship::models
