#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "client/experiments/studies/study.hpp"
#include "proto/types/problem.hpp"

namespace kinship::experiments {

/// Where something stands on the table: m, m, rad, in the task frame, whose origin lies at the
/// middle of the edge where the robots stand, x over the table, z up from its top.
struct TablePose {
  double x = 0, y = 0, yaw_rad = 0;
};

/// A box that stands on the table.
struct TableObject {
  std::string name;
  TablePose pose;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< m, full extents
};

/// A bin without lid: two containers fit in, one behind the other along its x.
struct Bin {
  double length_m = 0, width_m = 0;  ///< inside, along its x and y
  double height_m = 0;
  double wall_m = 0;
};

/// Carrying as it is meant: instances are this with noise.
struct CarryingLayout {
  std::string name;                  ///< instances are called <name>-<seed>-<index>
  TablePose pick;                    ///< of the container
  TablePose place;                   ///< middle of the two deposit places
  double between_places_m = 0;       ///< from one to the other, along x of `place`
  std::optional<Bin> bin;            ///< around `place`; without one both places are free
  std::vector<TableObject> objects;  ///< what else stands on the table
  Eigen::Vector3d container = Eigen::Vector3d::Zero();  ///< its size, m
  double tilt_rad = 0;                                  ///< by roll and by pitch, at most
  int goal_branches = 0;        ///< goal configurations of an instance, at most
  int least_goal_branches = 1;  ///< instances with fewer are drawn again
};

/// One instance of the task, whatever robot does it.
struct CarryingScene {
  Scene scene;
  Eigen::Isometry3d T_task_pick = Eigen::Isometry3d::Identity();  ///< of the transfer frame
  /// Of the transfer frame, with its hand one way or the other.
  std::vector<Eigen::Isometry3d> T_task_places;
};

/// Everything on the table has normal noise, cut at 2.5 standard deviations; with a bin, one of the
/// two places, at random, is taken by another container.
CarryingScene draw_carrying_scene(const CarryingLayout& layout, std::mt19937_64& generator);

/// The scene without noise; with a bin, the first place is taken.
CarryingScene nominal_carrying_scene(const CarryingLayout& layout);

/// The container in the transfer frame: its rim between the fingers.
Eigen::Isometry3d T_transfer_container(const CarryingLayout& layout);

/// Instances of a carrying task for one robot.
///
/// The scene depends on seed and index only. The start configuration is the robot's free one at the
/// nominal pick that is nearest to the middle of its limits, with noise in each joint, brought to
/// the instance's pick. The goals are free configurations with the hand one way and the other, by
/// turns, as many as the layout says at most. Where a robot has no free start, or fewer goals than
/// the layout wants, the instance is drawn again under the next sub-seed, and its name ends in
/// `.1`, `.2`, ...: equal names, equal scenes.
/// \throws Failure(NotFound) if the robot has no free configuration at the nominal pick; the
///         instances throw it where they find none in kMaxCarryingDraws draws.
DrawInstance make_carrying_instances(const CarryingLayout& layout, const models::LoadedRobot& robot,
                                     const StudyRobot& placed);

inline constexpr std::uint32_t kMaxCarryingDraws = 100;

}  // namespace kinship::experiments
