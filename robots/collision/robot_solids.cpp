#include "robots/collision/robot_solids.hpp"

#include <utility>

#include "robots/collision/always_touching.hpp"

namespace kinship::collision {
namespace {

constexpr TouchSamples kTouchSamples{.count = 200, .least = 190};

}  // namespace

RobotSolids::RobotSolids(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  Parts parts{chain, link_bodies(chain, shapes), {}};
  parts.unchecked = unchecked_links(parts.bodies, chain, shapes);
  if (shapes.never_colliding.empty())
    parts.unchecked.merge(links_always_touching(parts, kTouchSamples));
  parts_ = std::make_shared<const Parts>(std::move(parts));
}

std::vector<Body> bodies_among(const RobotSolids& robot, const Surroundings& surroundings) {
  std::vector<Body> bodies = robot.parts().bodies;
  add_surroundings(robot.parts().chain, surroundings, bodies);
  return bodies;
}

}  // namespace kinship::collision
