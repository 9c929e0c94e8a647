#pragma once

#include <string>
#include <vector>

#include "proto/types/result.hpp"
#include "robots/geometry/link_meshes.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::models {

/// A robot as described to a server, with the data that planning needs.
struct LoadedRobot : kinematics::RobotModel {
  geometry::RobotShapes shapes;
  std::vector<std::string> warnings = {};  ///< of describe_robot
};

/// A robot as a command line names it, with its collision meshes, to plan for.
/// \return also the errors of describe_robot, kinematics::read_model, geometry::read_shapes,
///         MeshFiles and geometry::find_missing_solids.
Result<LoadedRobot> load_robot(const RobotArguments& arguments);

/// The shapes of a robot. Links named as needing no solid are not among its
/// `visual_only` ones.
/// \param robot  made of the arguments.
/// \return also InvalidInput if such a link is missing or has solids.
Result<geometry::RobotShapes> load_shapes(const RobotArguments& arguments,
                                          const kinematics::RobotModel& robot);

/// The meshes of a robot's links, for its description.
/// \param robot  made of the arguments.
/// \return none if the arguments say so; the error of parse_packages; a mesh that cannot be read is
///         a note.
Result<geometry::LinkMeshes> load_meshes(const RobotArguments& arguments,
                                         const kinematics::RobotModel& robot);

}  // namespace kinship::models
