#include "server/transfer/scene_filter.hpp"

#include <set>

#include "robots/collision/always_touching.hpp"
#include "robots/collision/collision_world.hpp"
#include "server/transfer/collision_filter.hpp"

namespace kinship::transfer {
namespace {

constexpr int kSamples = 40;
constexpr int kAlways = 38;  // of kSamples

/// The same shapes, of which no two links are looked at together.
geometry::RobotShapes without_self_collision(geometry::RobotShapes shapes, std::size_t links) {
  shapes.never_colliding.clear();
  for (int first = 0; first < static_cast<int>(links); ++first)
    for (int second = first; second < static_cast<int>(links); ++second)
      shapes.never_colliding.emplace_back(first, second);
  return shapes;
}

collision::Surroundings surroundings_of(const kinematics::Chain& robot, const RecordedScene& scene,
                                        const Eigen::Isometry3d& T_task_base) {
  collision::Surroundings surroundings{T_task_base, {scene.objects}, {}, scene.allowed_collisions};
  for (const HeldObject& held : scene.held)
    surroundings.attached.push_back({held.name,
                                     robot.tip_link(),
                                     held.shape,
                                     robot.T_tip_transfer() * held.T_transfer_object,
                                     {}});
  return surroundings;
}

/// \param body  of which no two links are looked at together.
std::set<std::pair<std::string, std::string>> touching_everywhere(
    const kinematics::Chain& robot, const geometry::RobotShapes& body,
    const collision::Surroundings& surroundings) {
  collision::CollisionWorld world(robot, body, surroundings);
  return collision::always_touching(robot, kSamples, kAlways, [&world](const Eigen::VectorXd& q) {
    return world.find_contacts(q);
  });
}

}  // namespace

collision::Surroundings recorded_surroundings(const kinematics::Chain& robot,
                                              const geometry::RobotShapes& shapes,
                                              const RecordedScene& scene,
                                              const Eigen::Isometry3d& T_task_base) {
  collision::Surroundings surroundings = surroundings_of(robot, scene, T_task_base);
  for (const auto& names : touching_everywhere(
           robot, without_self_collision(shapes, robot.links().size()), surroundings))
    surroundings.allowed_collisions.push_back(names);
  return surroundings;
}

SceneFilter scene_filter(const kinematics::Chain& robot, const geometry::RobotShapes& shapes,
                         const RecordedScene& scene, const Eigen::Isometry3d& T_task_base) {
  SceneFilter filter;
  if (shapes.shapes.empty() || (scene.objects.empty() && scene.held.empty()))
    return filter;
  const geometry::RobotShapes body = without_self_collision(shapes, robot.links().size());
  collision::Surroundings surroundings = surroundings_of(robot, scene, T_task_base);
  for (const auto& names : touching_everywhere(robot, body, surroundings)) {
    filter.always_touching.push_back(names);
    surroundings.allowed_collisions.push_back(names);
  }
  filter.keep = collision_filter(robot, body, surroundings);
  return filter;
}

}  // namespace kinship::transfer
