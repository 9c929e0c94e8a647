#pragma once

#include "client/experiments/studies/kitting_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

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
