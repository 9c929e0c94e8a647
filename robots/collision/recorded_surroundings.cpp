#include "robots/collision/recorded_surroundings.hpp"

#include "robots/collision/pair_sampling.hpp"

namespace kinship::collision {
namespace {

constexpr TouchSamples kSamples{.count = 40, .least = 38};

}  // namespace

RecordedSurroundings recorded_surroundings(const RobotSolids& robot, const RecordedScene& scene,
                                           const Eigen::Isometry3d& T_task_base) {
  const kinematics::Chain& chain = robot.parts().chain;
  RecordedSurroundings recorded;
  Surroundings& surroundings = recorded.surroundings;
  surroundings = {
      T_task_base, {scene.objects, {}}, {}, scene.allowed_collisions, /*checks_links=*/false};
  for (const HeldObject& held : scene.held)
    surroundings.attached.push_back({held.name,
                                     chain.tip_link(),
                                     held.shape,
                                     chain.T_tip_transfer() * held.T_transfer_object,
                                     {}});
  for (const auto& names : always_touching(robot, surroundings, kSamples)) {
    recorded.always_touching.push_back(names);
    surroundings.allowed_collisions.push_back(names);
  }
  surroundings.checks_links = true;
  return recorded;
}

}  // namespace kinship::collision
