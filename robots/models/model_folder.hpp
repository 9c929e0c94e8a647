#pragma once

#include <filesystem>
#include <string_view>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::models {

inline constexpr std::string_view kChainFile = "chain.toml";
inline constexpr std::string_view kUrdfFile = "robot.urdf";

/// The robot of a folder with chain.toml and robot.urdf (README.md). The URDF is taken as text;
/// kinematics::read_chain judges it.
/// \return the description; NotFound if the folder or one of its files is missing; InvalidInput
///         or TooLarge that names file, field and value otherwise.
Result<RobotDescription> read_model_folder(const std::filesystem::path& folder);

}  // namespace kinship::models
