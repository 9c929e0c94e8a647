#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// What is dear to plan without experience.
enum class DearKind {
  LiftCage,   ///< a hand between the bars of a cage, an arm on a lift
  LiftShelf,  ///< a hand into one of the compartments of a shelf, an arm on a lift
  Window,     ///< a long tool with a wide head through a window in a wall
  Gun,        ///< a C-shaped gun about a bar of a frame
  Bin,        ///< a long gripper through the narrow mouth of a deep bin
  Upright,    ///< something that must stay upright through a window
  Cloud,      ///< a shelf that a sensor saw: a point cloud
  Beside      ///< a shelf that another arm reaches into
};

/// Of the study and its task, e.g. "dear_lift_cage".
std::string_view study_name(DearKind kind);

/// A part of what the hand holds.
struct HeldPart {
  std::string name;
  Shape shape;
  Eigen::Isometry3d T_transfer_part = Eigen::Isometry3d::Identity();
};

/// One instance, whatever robot does it. The furniture has other measures each time.
///
/// The task frame lies on the floor where the robots stand, x to the furniture, z up.
struct DearScene {
  Scene scene;
  Eigen::Isometry3d T_task_goal = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  std::optional<Eigen::Isometry3d> T_task_start = {};             ///< of it; missing: at home
  std::vector<HeldPart> held;
};

/// Equal generator, equal scene.
DearScene draw_dear_scene(DearKind kind, std::mt19937_64& generator);

/// The cubes of a grid that solids fill in part, as a sensor gives them that sees all surfaces.
/// \param solids  boxes.
/// \return        middles of the cubes: 3 x n, m, odd multiples of half an edge.
Eigen::Matrix3Xd voxels_in(const std::vector<SceneObject>& solids, double voxel_m);

/// Of a constrained kind: roll and pitch of what is carried, at most.
inline constexpr double kDearTilt_rad = 0.1;

/// Instances of a kind for one robot.
///
/// Scene, start pose and goal depend on kind, seed and index only; the start is StudyRobot::start,
/// or the configuration at the start pose that is nearest to it. Where that is not free, a goal is
/// missing under one of the seeds of an instance's queries, or the straight
/// line to a goal is free, the instance is drawn again under the next sub-seed, and its name ends
/// in `.1`, `.2`, ...: equal names, equal scenes.
/// \param max_goals  PlanSettings::max_goals of the study.
/// \throws Failure(InvalidInput) if the start is not one of the robot; the instances throw
///         Failure(NotFound) where they find none in kMaxDearDraws draws.
DrawInstance make_dear_instances(DearKind kind, int max_goals, const models::LoadedRobot& robot,
                                 const StudyRobot& placed);

inline constexpr std::uint32_t kMaxDearDraws = 2000;

}  // namespace kinship::experiments
