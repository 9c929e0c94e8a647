#pragma once

#include <string>
#include <vector>

#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// Where something is in the plane of the arms: m, m, rad, in the task frame.
struct PlanarPose {
  double x = 0, y = 0, yaw_rad = 0;
};

/// A box in the plane.
struct PlanarBox {
  PlanarPose pose;
  double half_x = 0, half_y = 0;  ///< m
};

/// A task in the plane as it is meant: instances are this with noise.
struct PlanarLayout {
  std::string name;  ///< instances are called <name>-<seed>-<index>
  std::vector<PlanarBox> boxes;
  PlanarPose start, goal;  ///< of the transfer frame
  double spare_m = 0;      ///< what the carried box has to spare on each side at the goal, at least
};

/// Instances of a planar task for one arm that carries a small box.
///
/// Every box, the start pose and the goal pose have normal noise, cut at 2.5 standard deviations;
/// they depend on seed and index only. The start configuration is the arm's most stretched one at
/// the nominal start pose, with noise in each joint, brought to the instance's start pose. Where an
/// arm has no free start, or no free goal with a carried box as much larger as it has to have to
/// spare, the instance is drawn again under the next sub-seed, and its name ends in `.1`, `.2`,
/// ...: equal names, equal scenes. \throws Failure(NotFound) if the arm has no free configuration
/// at the nominal start pose; the
///         instances throw it where they find none in kMaxPlanarDraws draws.
DrawInstance make_planar_instances(const PlanarLayout& layout, const models::LoadedRobot& robot,
                                   const StudyRobot& placed);

inline constexpr std::uint32_t kMaxPlanarDraws = 100;

}  // namespace kinship::experiments
