#pragma once

#include "client/experiments/studies/carrying_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

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
