#pragma once

#include "client/experiments/studies/furniture_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

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
