#include "robots/collision/body_pairs.hpp"

#include <algorithm>
#include <set>

#include "robots/collision/link_pairs.hpp"

namespace kinship::collision {
namespace {

class Permissions {
 public:
  explicit Permissions(const Surroundings& surroundings) {
    for (const auto& [a, b] : surroundings.allowed_collisions)
      allowed_.insert(std::minmax(a, b));
  }

  bool may_touch(const Body& a, const Body& b) const {
    return touches_link(a, b) || touches_link(b, a) ||
           allowed_.count(std::minmax(a.name, b.name)) > 0;
  }

 private:
  static bool touches_link(const Body& attached, const Body& link) {
    return link.kind == BodyKind::Link &&
           std::find(attached.touch_links.begin(), attached.touch_links.end(), link.name) !=
               attached.touch_links.end();
  }

  std::set<std::pair<std::string, std::string>> allowed_;  // first <= second
};

}  // namespace

LinkPairs unchecked_links(const std::vector<Body>& bodies, const kinematics::Chain& chain,
                          const geometry::RobotShapes& shapes) {
  std::vector<bool> has_shape(chain.links().size(), false);
  for (const Body& body : bodies)
    if (body.kind == BodyKind::Link)
      has_shape[static_cast<std::size_t>(body.link)] = true;
  const auto neighbours = neighbouring_links(chain, has_shape);
  LinkPairs pairs(neighbours.begin(), neighbours.end());
  pairs.insert(shapes.never_colliding.begin(), shapes.never_colliding.end());
  return pairs;
}

std::vector<BodyPair> moving_pairs(const std::vector<Body>& bodies, const LinkPairs& unchecked,
                                   const Surroundings& surroundings) {
  const Permissions permissions(surroundings);
  std::vector<BodyPair> pairs;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Body &a = bodies[i], &b = bodies[j];
      if (a.joint == b.joint || permissions.may_touch(a, b))
        continue;
      const bool links = a.kind == BodyKind::Link && b.kind == BodyKind::Link;
      if (links && unchecked.count(std::minmax(a.link, b.link)) > 0)
        continue;
      pairs.emplace_back(i, j);
    }
  const auto last_joint = [&](const BodyPair& pair) {
    return std::max(bodies[pair.first].joint, bodies[pair.second].joint);
  };
  std::stable_sort(pairs.begin(), pairs.end(), [&](const BodyPair& a, const BodyPair& b) {
    return last_joint(a) > last_joint(b);
  });
  return pairs;
}

std::vector<BodyPair> standing_pairs(const std::vector<Body>& bodies,
                                     const Surroundings& surroundings) {
  const Permissions permissions(surroundings);
  std::vector<BodyPair> pairs;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Body &a = bodies[i], &b = bodies[j];
      if (a.joint < 0 && b.joint < 0 && a.kind != BodyKind::Obstacle &&
          b.kind == BodyKind::Obstacle && !permissions.may_touch(a, b))
        pairs.emplace_back(i, j);
    }
  return pairs;
}

}  // namespace kinship::collision
