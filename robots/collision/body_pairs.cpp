#include "robots/collision/body_pairs.hpp"

#include <algorithm>
#include <cstdlib>
#include <set>

namespace kinship::collision {
namespace {

/// Parent and children of each link.
std::vector<std::vector<int>> tree_edges(const std::vector<kinematics::ChainLink>& links) {
  std::vector<std::vector<int>> edges(links.size());
  for (std::size_t child = 0; child < links.size(); ++child) {
    const int parent = links[child].parent;
    if (parent < 0)
      continue;
    edges[child].push_back(parent);
    edges[static_cast<std::size_t>(parent)].push_back(static_cast<int>(child));
  }
  return edges;
}

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

std::vector<std::pair<int, int>> neighbouring_links(const kinematics::Chain& chain,
                                                    const std::vector<bool>& has_shape) {
  const auto& links = chain.links();
  const auto joint = [&](int link) { return links[static_cast<std::size_t>(link)].joint; };
  const std::vector<std::vector<int>> edges = tree_edges(links);
  std::vector<std::pair<int, int>> pairs;
  for (int first = 0; first < static_cast<int>(links.size()); ++first) {
    if (!has_shape[static_cast<std::size_t>(first)])
      continue;
    // Walk outwards through links without a shape; a tree needs no memory but where we came from.
    std::vector<std::pair<int, int>> frontier = {{first, -1}};  // link, link before it
    while (!frontier.empty()) {
      const auto [link, before] = frontier.back();
      frontier.pop_back();
      for (const int next : edges[static_cast<std::size_t>(link)]) {
        if (next == before)
          continue;
        if (!has_shape[static_cast<std::size_t>(next)])
          frontier.emplace_back(next, link);
        else if (first < next && std::abs(joint(first) - joint(next)) == 1)
          pairs.emplace_back(first, next);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

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
