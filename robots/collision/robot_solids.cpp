#include "robots/collision/robot_solids.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "robots/collision/robot_parts.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {
namespace {

constexpr int kTouchSamples = 200;
constexpr int kAlwaysTouching = 190;  // of kTouchSamples
constexpr std::uint64_t kTouchSeed = 1;

Eigen::VectorXd random_configuration(const kinematics::Chain& chain, std::mt19937_64& generator) {
  Eigen::VectorXd q(chain.dof());
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
  return q;
}

/// Links that touch wherever the robot is, not those that are unchecked anyway.
LinkPairs always_touching(const RobotSolids::Parts& robot) {
  const std::vector<Body>& bodies = robot.bodies;
  const std::vector<BodyPair> pairs = moving_pairs(bodies, robot.unchecked, {});
  std::vector<Eigen::Isometry3d> T_base_bodies = standing_poses(bodies);
  std::mt19937_64 generator(kTouchSeed);
  std::map<std::pair<int, int>, int> touches;  // by links: a pair counts once per configuration
  for (int sample = 0; sample < kTouchSamples; ++sample) {
    place_bodies(robot.chain, bodies, random_configuration(robot.chain, generator), T_base_bodies);
    LinkPairs touched;
    for (const auto& [a, b] : pairs)
      if (touch(bodies[a].solid, T_base_bodies[a], bodies[b].solid, T_base_bodies[b]))
        touched.insert(std::minmax(bodies[a].link, bodies[b].link));
    for (const auto& links : touched)
      ++touches[links];
  }
  LinkPairs always;
  for (const auto& [links, count] : touches)
    if (count >= kAlwaysTouching)
      always.insert(links);
  return always;
}

}  // namespace

RobotSolids::RobotSolids(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  Parts parts{chain, link_bodies(chain, shapes), {}};
  parts.unchecked = unchecked_links(parts.bodies, chain, shapes);
  if (shapes.never_colliding.empty())
    parts.unchecked.merge(always_touching(parts));
  parts_ = std::make_shared<const Parts>(std::move(parts));
}

void place_bodies(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                  const Eigen::Ref<const Eigen::VectorXd>& q,
                  std::vector<Eigen::Isometry3d>& T_base_bodies) {
  const std::vector<Eigen::Isometry3d> T_base_joints = kinematics::joint_poses(chain, q);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].joint >= 0)
      T_base_bodies[i] =
          T_base_joints[static_cast<std::size_t>(bodies[i].joint)] * bodies[i].T_joint_body;
}

std::vector<Eigen::Isometry3d> standing_poses(const std::vector<Body>& bodies) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Body& body : bodies)
    poses.push_back(body.T_joint_body);
  return poses;
}

}  // namespace kinship::collision
