#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <random>

#include "client/experiments/studies/study.hpp"
#include "proto/types/scene.hpp"

namespace kinship::experiments {

inline constexpr std::size_t kKittingRows = 2, kKittingColumns = 5;
inline constexpr std::size_t kKittingCompartments = kKittingRows * kKittingColumns;

/// One instance, whatever robot does it: a part is taken from a worktable and put into one of the
/// ten compartments of the rack at its back.
///
/// The task frame lies on the worktable's top in the middle of the edge where the robots stand, x
/// over the table, z up. Table and rack never move.
struct KittingScene {
  Scene scene;
  Eigen::Isometry3d T_task_pick = Eigen::Isometry3d::Identity();   ///< of the transfer frame
  Eigen::Isometry3d T_task_place = Eigen::Isometry3d::Identity();  ///< of the transfer frame
};

/// The part to fetch lies anywhere on the part of the table before the rack, others lie around it.
/// \param compartment  the goal, below kKittingCompartments.
KittingScene draw_kitting_scene(std::size_t compartment, std::mt19937_64& generator);

/// Where the part of an instance goes: ten instances on end fill the ten compartments, in random
/// order.
std::size_t compartment_of(std::uint64_t seed, std::uint32_t index);

/// Pose of the transfer frame over the middle of where parts lie.
Eigen::Isometry3d T_task_nominal_pick();

/// The held part, and its pose in the transfer frame.
BoxShape kitting_part();
Eigen::Isometry3d T_transfer_part();

/// Instances of kitting for one robot.
///
/// Scene, pick and place depend on seed and index only. The start configuration is that of
/// StudyRobot::start, or where there is none the free one over the middle of the parts that is
/// nearest to the middle of the limits, with noise in each joint, brought to the instance's pick.
/// Where a robot has no free start, or planning would find no goal under one of the seeds of an
/// instance's queries, the parts are drawn again under the next sub-seed, the compartment stays,
/// and the name ends in `.1`, `.2`, ...: equal names, equal scenes.
/// \param max_goals  PlanSettings::max_goals of the study.
/// \throws Failure(NotFound) if the robot has no free configuration over the parts; the instances
///         throw it where they find none in kMaxKittingDraws draws.
DrawInstance make_kitting_instances(int max_goals, const models::LoadedRobot& robot,
                                    const StudyRobot& placed);

inline constexpr std::uint32_t kMaxKittingDraws = 100;

}  // namespace kinship::experiments
