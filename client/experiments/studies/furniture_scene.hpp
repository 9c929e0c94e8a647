#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// What the furniture of a study is.
enum class FurnitureKind { Shelf, TallShelf, Box, Cage, Table };

/// From where a hand takes what stands on a board.
enum class Approach { Forward, Downward };

/// Where things stand.
struct Board {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of its top, m
  double half_x = 0, half_y = 0;                     ///< m, to where the middle of a thing may be
  Approach approach = Approach::Forward;
};

/// A piece of furniture in its own frame: origin on the floor below its middle, x from who stands
/// before it to its back, y to the left, z up.
struct Furniture {
  std::vector<SceneObject> solids;
  std::vector<Board> boards;
  double nominal_x = 0;    ///< m, before the robots: where its origin stands in the task frame
  std::size_t things = 0;  ///< that stand on its boards besides the one to grasp
};

Furniture make_furniture(FurnitureKind kind);

/// Five cobots before the furniture, each at its home: elbow bent, the hand before it at the height
/// of its shoulder or lower.
std::vector<StudyRobot> cobots_at_home();

/// Of the study and its task, e.g. "furniture_tall_shelf".
std::string_view study_name(FurnitureKind kind);

/// How far furniture stands from its nominal place, uniformly.
inline constexpr double kFurnitureShift_m = 0.4;
inline constexpr double kFurnitureTurn_rad = std::numbers::pi / 3;

/// One instance, whatever robot does it: something that stands anywhere on a board is to be
/// grasped.
///
/// The task frame lies on the floor where the robots stand, x to the furniture, z up.
struct FurnitureScene {
  Scene scene;
  Eigen::Isometry3d T_task_furniture = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_task_grasp = Eigen::Isometry3d::Identity();  ///< of the transfer frame
};

/// Furniture stands up to kFurnitureShift_m and kFurnitureTurn_rad from its nominal place. The
/// thing to grasp is anywhere on one of its boards, others are elsewhere on them; the hand comes
/// forward or downward, as the board says, turned about the vertical. Equal generator, equal scene.
FurnitureScene draw_furniture_scene(FurnitureKind kind, std::mt19937_64& generator);

/// Names of the floor, which robots stand on, and of what is to be grasped.
inline constexpr const char* kFloorName = "floor";
inline constexpr const char* kTargetName = "target";

/// Instances of grasping from furniture for one robot.
///
/// The scene and the pose of the grasp depend on kind, seed and index only; the start is the
/// robot's home, StudyRobot::start. Where that is not free, or planning would find no goal under
/// one of the seeds of an instance's queries, the instance is drawn again under the next sub-seed,
/// and its name ends in `.1`, `.2`, ...: equal names, equal scenes.
/// \param max_goals  PlanSettings::max_goals of the study.
/// \throws Failure(InvalidInput) if the start is not one of the robot; the instances throw
///         Failure(NotFound) where they find none in kMaxFurnitureDraws draws.
DrawInstance make_furniture_instances(FurnitureKind kind, int max_goals,
                                      const models::LoadedRobot& robot, const StudyRobot& placed);

inline constexpr std::uint32_t kMaxFurnitureDraws = 1000;

}  // namespace kinship::experiments
