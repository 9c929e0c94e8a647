#include "robots/collision/robot_solids.hpp"

#include <algorithm>
#include <utility>

#include "robots/collision/always_touching.hpp"

namespace kinship::collision {
namespace {

constexpr int kTouchSamples = 200;
constexpr int kAlwaysTouching = 190;  // of kTouchSamples

/// Links that touch wherever the robot is, not those that are unchecked anyway.
LinkPairs touching_links(const RobotSolids::Parts& robot) {
  const std::vector<Body>& bodies = robot.bodies;
  const std::vector<BodyPair> pairs = moving_pairs(bodies, robot.unchecked, {});
  std::vector<Eigen::Isometry3d> T_base_bodies = standing_poses(bodies);
  return always_touching(
      robot.chain, kTouchSamples, kAlwaysTouching, [&](const Eigen::VectorXd& q) {
        place_bodies(robot.chain, bodies, q, T_base_bodies);
        LinkPairs touched;
        for (const auto& [a, b] : pairs)
          if (touch(bodies[a].solid, T_base_bodies[a], bodies[b].solid, T_base_bodies[b]))
            touched.insert(std::minmax(bodies[a].link, bodies[b].link));
        return touched;
      });
}

}  // namespace

RobotSolids::RobotSolids(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  Parts parts{chain, link_bodies(chain, shapes), {}};
  parts.unchecked = unchecked_links(parts.bodies, chain, shapes);
  if (shapes.never_colliding.empty())
    parts.unchecked.merge(touching_links(parts));
  parts_ = std::make_shared<const Parts>(std::move(parts));
}

}  // namespace kinship::collision
