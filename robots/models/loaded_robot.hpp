#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/types/result.hpp"
#include "robots/geometry/link_meshes.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/mesh_files.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::models {

/// A robot as described to a server, with the data that planning needs.
struct LoadedRobot : kinematics::RobotModel {
  geometry::RobotShapes shapes;
  std::vector<std::string> warnings = {};            ///< of describe_robot
  std::optional<double> limit_slack = std::nullopt;  ///< see RobotArguments
};

/// A robot as a command line names it, with its collision meshes, to plan for.
/// \return also the errors of describe_robot, kinematics::read_model, geometry::read_shapes,
///         MeshFiles and geometry::find_faults.
Result<LoadedRobot> load_robot(const RobotArguments& arguments);

/// The shapes of a robot. Links named as needing no solid are not among its
/// `visual_only` ones.
/// \param robot  made of the arguments.
/// \return also InvalidInput if such a link is missing or has solids.
Result<geometry::RobotShapes> load_shapes(const RobotArguments& arguments,
                                          const kinematics::RobotModel& robot);

/// Folders of the packages that the arguments or the folder of a robot name, for problems too.
/// \return also the errors of resolve() and parse_packages().
Result<PackageFolders> packages_of(const RobotArguments& arguments);

/// Adds the meshes of a robot's links to its description, for a server; none if the arguments say
/// so.
/// \param robot  made of the arguments.
/// \return a sentence on each mesh that stays here or was simplified; or the error of
///         parse_packages, and nothing changes.
Result<std::vector<std::string>> add_meshes(const RobotArguments& arguments,
                                            kinematics::RobotModel& robot);

}  // namespace kinship::models
