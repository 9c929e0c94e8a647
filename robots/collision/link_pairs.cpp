#include "robots/collision/link_pairs.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

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

}  // namespace kinship::collision
