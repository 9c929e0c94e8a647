#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/problem.hpp"
#include "proto/types/result.hpp"
#include "robots/kinematics/chain.hpp"

/// Conversion of MoveIt's messages in YAML to problems.
namespace kinship::moveit {

/// A mesh contained in a scene; a problem names a file.
struct MeshFile {
  std::string name;  ///< in the problem
  std::string obj;   ///< its text, Wavefront OBJ
};

struct Conversion {
  Problem problem;
  std::vector<MeshFile> meshes;  ///< to be written beside the problem file
  /// Texts on parts that a problem cannot express and planning does not need.
  std::vector<std::string> left_out;
};

struct ConversionInput {
  /// moveit_msgs/PlanningScene, one for all requests or one for each, or a `.scene` exported by
  /// RViz; empty: no obstacles.
  std::filesystem::path scene;
  std::filesystem::path request;  ///< moveit_msgs/MotionPlanRequest, one per document
  /// The robot's base in the task frame; empty: the task frame is MoveIt's planning frame, that of
  /// the URDF's root link.
  std::optional<Eigen::Isometry3d> T_task_base;
  std::string name;  ///< of the problem; of several NAME-1, NAME-2 ...
};

/// Reads planning scenes and requests as problems for a robot, one per request: obstacles and
/// attached objects, pairs that may touch, start, goal, time limit and an orientation to be kept on
/// the way.
/// \return NotFound or InvalidInput that names file, line and member; also for parts that a problem
///         cannot express and that must not be left out: an octomap, a cone, a plane, a change to
///         another scene, another path constraint.
Result<std::vector<Conversion>> read_problems(const ConversionInput& input,
                                              const kinematics::Chain& chain);

}  // namespace kinship::moveit
