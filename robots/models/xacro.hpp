#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::models {

/// What marks a text as xacro that is still to be expanded: an element `xacro:...`, or `${...}`,
/// `$(find ...)`, `$(arg ...)` in an attribute of an element of the model; with its line, in words.
/// Empty if it is none, or no XML. What plugins are told (`<gazebo>`, `<ros2_control>`) does not
/// count, and neither does a mere declaration xmlns:xacro, which expanded files keep.
std::string xacro_mark(std::string_view text);

/// What to say of a file whose text is xacro: what shows it, and how it is expanded.
/// \param ending  of what comes out of it, ".urdf" or ".srdf".
std::optional<Error> check_expanded(const std::filesystem::path& file, std::string_view text,
                                    std::string_view ending);

}  // namespace kinship::models
