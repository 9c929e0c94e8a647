#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/chain_file.hpp"
#include "robots/models/xacro.hpp"

namespace kinship::models {

/// A robot as a command line names it: a model folder, or a URDF file with the missing data.
/// Arguments beside a model folder replace the values of its chain.toml.
struct RobotArguments {
  std::filesystem::path source = {};  ///< a folder with chain.toml, a URDF file, or a robot's name
  std::string base_link = {};         ///< required for a URDF file
  std::string tip_link = {};          ///< required for a URDF file
  std::string label = {};  ///< empty: the folder's, or the URDF file's name without ending
  std::string transfer =
      {};                 ///< T_tip_transfer, "x y z qx qy qz qw"; empty: the folder's or identity
  std::string axes = {};  ///< e.g. "x,y,yaw"; empty: the folder's or all six
  std::vector<std::string> held = {};  ///< "JOINT=VALUE" each
  std::filesystem::path srdf = {};     ///< instead of the folder's; adds to its never_colliding
  std::vector<std::string> packages =
      {};  ///< "NAME=DIR" each, for meshes named package://NAME/...; count before the folder's
  bool collision_from_visual = false;  ///< links without collision elements get their visuals
  bool without_meshes = false;         ///< no server is sent the meshes
  std::vector<std::string> without_collision = {};  ///< links that may have visuals and no solid
  std::vector<std::string> xacro = {};  ///< "NAME:=VALUE" each, for a URDF or SRDF that is xacro
  std::vector<std::filesystem::path> mesh_folders =
      {};  ///< where meshes are looked for that are not where the URDF says, before the folder's
  std::optional<double> limit_slack = std::nullopt;  ///< see ChainFile; none: the folder's
};

/// Arguments that say all that the files of a robot do not.
struct ResolvedArguments {
  RobotArguments arguments;        ///< the source is a URDF file
  std::optional<ChainFile> chain;  ///< of a model folder
};

/// Adds what the chain.toml of a model folder says where the arguments say nothing.
/// \return the errors of read_chain_file().
Result<ResolvedArguments> resolve(RobotArguments arguments);

/// The robot of a model folder (README.md). The URDF is taken as text, unless an SRDF needs its
/// links; kinematics::read_model judges it.
/// \return the description; NotFound if the folder or one of its files is missing; InvalidInput
///         or TooLarge that names file, field and value otherwise.
Result<RobotDescription> read_model_folder(const std::filesystem::path& folder);

/// The name of a URDF file, or of an xacro file, as a label, which it may be unfit for.
std::string label_of(const std::filesystem::path& urdf);

/// How the URDF file of a robot is read.
XacroInput urdf_input(const RobotArguments& arguments);

/// The description that the files of a robot make.
struct DescribedRobot {
  RobotDescription description;
  kinematics::UrdfModel urdf = {};  ///< if it was parsed: an SRDF needs the links
  /// On parts of the files that the robot cannot have: links that an SRDF names and the URDF does
  /// not have.
  std::vector<std::string> warnings = {};
  std::optional<double> limit_slack = std::nullopt;  ///< see RobotArguments
};

/// Reads the files and makes the description. The URDF is taken as text, unless an SRDF needs its
/// links.
/// \return InvalidInput, NotFound or TooLarge with the argument or file named.
Result<DescribedRobot> describe_robot(const RobotArguments& arguments);

/// With the chain.
/// \return also the errors of kinematics::read_model and geometry::find_impossible_lengths.
Result<kinematics::RobotModel> read_model(DescribedRobot robot);

/// Whether the transfer frame is given: by `transfer`, or by a model folder, whose chain.toml must
/// have it. Otherwise it is the tip link's frame.
bool says_transfer(const RobotArguments& arguments);

/// Numbers with blanks or commas between them, one at least.
Result<std::vector<double>> parse_numbers(std::string_view text);

/// "x y z qx qy qz qw" (blanks or commas) as a pose.
Result<Eigen::Isometry3d> parse_pose(std::string_view text);

}  // namespace kinship::models
