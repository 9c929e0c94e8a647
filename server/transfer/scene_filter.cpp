#include "server/transfer/scene_filter.hpp"

#include <map>
#include <random>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "server/transfer/collision_filter.hpp"

namespace kinship::transfer {
namespace {

using Names = std::pair<std::string, std::string>;

constexpr int kSamples = 40;
constexpr int kAlways = 38;  // of kSamples
constexpr std::uint64_t kSeed = 1;

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

Eigen::VectorXd random_configuration(const kinematics::Chain& robot, std::mt19937_64& generator) {
  Eigen::VectorXd q(robot.dof());
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q[i] = std::uniform_real_distribution<double>(robot.lower()[i], robot.upper()[i])(generator);
  return q;
}

/// The pairs that touch in almost every random configuration, whatever else does.
std::vector<Names> always_touching(const kinematics::Chain& robot,
                                   collision::CollisionWorld world) {
  std::mt19937_64 generator(kSeed);
  std::map<Names, int> touched;
  for (int sample = 0; sample < kSamples; ++sample)
    for (const Names& names : world.find_contacts(random_configuration(robot, generator)))
      ++touched[names];
  std::vector<Names> always;
  for (const auto& [names, count] : touched)
    if (count >= kAlways)
      always.push_back(names);
  return always;
}

}  // namespace

SceneFilter scene_filter(const kinematics::Chain& robot, const geometry::RobotShapes& shapes,
                         const RecordedScene& scene, const Eigen::Isometry3d& T_task_base) {
  SceneFilter filter;
  if (shapes.shapes.empty() || (scene.objects.empty() && scene.held.empty()))
    return filter;
  const geometry::RobotShapes body = without_self_collision(shapes, robot.links().size());
  collision::Surroundings surroundings = surroundings_of(robot, scene, T_task_base);
  filter.always_touching =
      always_touching(robot, collision::CollisionWorld(robot, body, surroundings));
  for (const Names& names : filter.always_touching)
    surroundings.allowed_collisions.push_back(names);
  filter.keep = collision_filter(robot, body, surroundings);
  return filter;
}

}  // namespace kinship::transfer
