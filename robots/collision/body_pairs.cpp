#include "robots/collision/body_pairs.hpp"

#include <algorithm>
#include <map>
#include <string_view>

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

/// Which pairs of some bodies may touch, by their indices: there are many pairs, and few of these.
class Permissions {
 public:
  Permissions(const std::vector<Body>& bodies, const Surroundings& surroundings)
      : is_named_(bodies.size(), false) {
    std::map<std::string_view, std::vector<std::size_t>> named;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      named[bodies[i].name].push_back(i);
    for (const auto& [a, b] : surroundings.allowed_collisions)
      for (const std::size_t i : named[a])
        for (const std::size_t j : named[b])
          permit(i, j);
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (const std::string& link : bodies[i].touch_links)
        for (const std::size_t j : named[link])
          if (bodies[j].kind == BodyKind::Link)
            permit(i, j);
    std::sort(permitted_.begin(), permitted_.end());
  }

  bool may_touch(std::size_t i, std::size_t j) const {
    return is_named_[i] && is_named_[j] &&
           std::binary_search(permitted_.begin(), permitted_.end(), BodyPair(std::minmax(i, j)));
  }

 private:
  void permit(std::size_t i, std::size_t j) {
    permitted_.emplace_back(std::minmax(i, j));
    is_named_[i] = is_named_[j] = true;
  }

  std::vector<bool> is_named_;       // in a pair
  std::vector<BodyPair> permitted_;  // first <= second, ascending
};

}  // namespace

std::vector<std::pair<int, int>> neighbouring_links(const kinematics::Chain& chain,
                                                    const std::vector<bool>& has_shape) {
  const auto& links = chain.links();
  const auto are_joined = [&](int first, int second) {  // by one moving joint
    const int a = links[static_cast<std::size_t>(first)].joint;
    const int b = links[static_cast<std::size_t>(second)].joint;
    return (a >= 0 && chain.joint_before(a) == b) || (b >= 0 && chain.joint_before(b) == a);
  };
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
        else if (first < next && are_joined(first, next))
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
  const Permissions permissions(bodies, surroundings);
  std::vector<std::vector<BodyPair>> of_joint;  // by the last joint that moves either
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Body &a = bodies[i], &b = bodies[j];
      if (a.joint == b.joint)
        continue;
      const bool links = a.kind == BodyKind::Link && b.kind == BodyKind::Link;
      if (links && (!surroundings.checks_links || unchecked.count(std::minmax(a.link, b.link)) > 0))
        continue;
      if (permissions.may_touch(i, j))
        continue;
      const auto joint = static_cast<std::size_t>(std::max(a.joint, b.joint));
      of_joint.resize(std::max(of_joint.size(), joint + 1));
      of_joint[joint].emplace_back(i, j);
    }
  std::vector<BodyPair> pairs;
  for (auto joint = of_joint.rbegin(); joint != of_joint.rend(); ++joint)
    pairs.insert(pairs.end(), joint->begin(), joint->end());
  return pairs;
}

std::vector<BodyPair> standing_pairs(const std::vector<Body>& bodies,
                                     const Surroundings& surroundings) {
  const Permissions permissions(bodies, surroundings);
  std::vector<BodyPair> pairs;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Body &a = bodies[i], &b = bodies[j];
      if (a.joint < 0 && b.joint < 0 && a.kind != BodyKind::Obstacle &&
          b.kind == BodyKind::Obstacle && !permissions.may_touch(i, j))
        pairs.emplace_back(i, j);
    }
  return pairs;
}

}  // namespace kinship::collision
