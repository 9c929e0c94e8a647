#include "robots/collision/robot_solids.hpp"

#include <utility>

#include "robots/collision/pair_sampling.hpp"

namespace kinship::collision {

RobotSolids::RobotSolids(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  Parts parts{chain, link_bodies(chain, shapes), {}, {}, {}};
  parts.unchecked = unchecked_links(parts.bodies, chain, shapes);
  if (shapes.never_colliding.empty())
    parts.always_touching = links_always_touching(parts, kLinkSamples);
  parts.unchecked.insert(parts.always_touching.begin(), parts.always_touching.end());
  parts.checked = checked_links(parts.bodies, parts.unchecked);
  parts_ = std::make_shared<const Parts>(std::move(parts));
}

std::string describe_always_touching(const RobotSolids& robot) {
  constexpr std::size_t kNamed = 8;
  const RobotSolids::Parts& parts = robot.parts();
  const auto name = [&parts](int link) {
    return "'" + parts.chain.links()[static_cast<std::size_t>(link)].name + "'";
  };
  std::string text;
  std::size_t named = 0;
  for (const auto& [first, second] : parts.always_touching)
    if (named++ < kNamed)
      text += (text.empty() ? "" : ", ") + name(first) + " and " + name(second);
  if (named == 0)
    return "";
  if (named > kNamed)
    text += " and " + std::to_string(named - kNamed) + " more pairs";
  return text +
         " touch wherever the robot goes, so they are not checked against each other: look at the "
         "scale and the poses of their solids; if they are right, an SRDF says so ('kinship robots "
         "suggest-srdf' makes one)";
}

std::vector<Body> bodies_among(const RobotSolids& robot, const Surroundings& surroundings) {
  std::vector<Body> bodies = robot.parts().bodies;
  add_surroundings(robot.parts().chain, surroundings, bodies);
  return bodies;
}

}  // namespace kinship::collision
