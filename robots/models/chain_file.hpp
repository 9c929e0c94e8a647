#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/task_axes.hpp"

namespace kinship::models {

inline constexpr std::string_view kChainFile = "chain.toml";
inline constexpr std::string_view kUrdfFile = "robot.urdf";

/// Largest limit_slack, joint units.
inline constexpr double kMaxLimitSlack = 0.1;

/// What the chain.toml of a model folder says of a robot. README.md has the fields.
struct ChainFile {
  std::string label, base_link, tip_link;
  Eigen::Isometry3d T_tip_transfer = Eigen::Isometry3d::Identity();
  TaskAxes task_axes = {};
  std::map<std::string, double> held = {};  ///< joints off the chain, joint units
  std::vector<std::pair<std::string, std::string>> never_colliding = {};
  // Files and folders: as the file has them, those that are relative below its folder.
  std::filesystem::path urdf = kUrdfFile;
  std::filesystem::path srdf = {};  ///< empty: none
  std::map<std::string, std::filesystem::path> packages = {};
  std::vector<std::filesystem::path> mesh_folders = {};
  std::vector<std::string> xacro = {};  ///< "NAME:=VALUE" each
  bool collision_from_visual = false;
  std::vector<std::string> without_collision = {};
  /// How far a start or goal may be beyond a joint limit and is moved onto it, joint units; none:
  /// the planner's default.
  std::optional<double> limit_slack = std::nullopt;
};

/// \param source  a folder, a file, or the name of a robot that comes along with Kinship, e.g.
/// "ur10e". \return the folder of such a robot, if there is nothing of that name here; else
/// `source`.
std::filesystem::path place_of_robot(const std::filesystem::path& source);

/// Whether a path names a model folder.
bool is_model_folder(const std::filesystem::path& source);

/// \return NotFound if there is no chain.toml; InvalidInput or TooLarge that names file, field and
///         value, of an unknown field with the nearest one.
Result<ChainFile> read_chain_file(const std::filesystem::path& folder);

/// The text of a chain.toml, with a comment on each field. Files and folders are written as they
/// are; what is at its default is left out.
std::string chain_file_text(const ChainFile& chain);

}  // namespace kinship::models
