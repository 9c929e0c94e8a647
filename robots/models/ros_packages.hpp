#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace kinship::models {

/// Where a ROS package is, or the places that were searched for it.
struct PackageSearch {
  std::optional<std::filesystem::path> folder;
  std::string places;  ///< for an error: each place with its value
};

/// Searches for a package as ROS does: PREFIX/share/NAME of AMENT_PREFIX_PATH, then folders below
/// those of ROS_PACKAGE_PATH whose package.xml has the name, then `beside` and the folders above
/// it likewise. Folders that hide, nest deeply or say COLCON_IGNORE are not entered.
/// \param beside  folder of the file that names the package.
PackageSearch find_ros_package(const std::string& name, const std::filesystem::path& beside);

}  // namespace kinship::models
