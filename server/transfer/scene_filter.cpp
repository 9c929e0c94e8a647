#include "server/transfer/scene_filter.hpp"

#include <set>

#include "robots/collision/pair_sampling.hpp"
#include "server/transfer/collision_filter.hpp"

namespace kinship::transfer {
namespace {

constexpr collision::TouchSamples kSamples{.count = 40, .least = 38};

/// Without a look at how links touch each other.
collision::Surroundings surroundings_of(const kinematics::Chain& robot, const RecordedScene& scene,
                                        const Eigen::Isometry3d& T_task_base) {
  collision::Surroundings surroundings{
      T_task_base, {scene.objects, {}}, {}, scene.allowed_collisions, /*checks_links=*/false};
  for (const HeldObject& held : scene.held)
    surroundings.attached.push_back({held.name,
                                     robot.tip_link(),
                                     held.shape,
                                     robot.T_tip_transfer() * held.T_transfer_object,
                                     {}});
  return surroundings;
}

}  // namespace

collision::Surroundings recorded_surroundings(const collision::RobotSolids& robot,
                                              const RecordedScene& scene,
                                              const Eigen::Isometry3d& T_task_base) {
  collision::Surroundings surroundings = surroundings_of(robot.parts().chain, scene, T_task_base);
  for (const auto& names : collision::always_touching(robot, surroundings, kSamples))
    surroundings.allowed_collisions.push_back(names);
  surroundings.checks_links = true;
  return surroundings;
}

SceneFilter scene_filter(const collision::RobotSolids& robot, const RecordedScene& scene,
                         const Eigen::Isometry3d& T_task_base) {
  SceneFilter filter;
  if (robot.parts().bodies.empty() || (scene.objects.empty() && scene.held.empty()))
    return filter;
  collision::Surroundings surroundings = surroundings_of(robot.parts().chain, scene, T_task_base);
  for (const auto& names : collision::always_touching(robot, surroundings, kSamples)) {
    filter.always_touching.push_back(names);
    surroundings.allowed_collisions.push_back(names);
  }
  filter.keep = collision_filter(robot, surroundings);
  return filter;
}

}  // namespace kinship::transfer
