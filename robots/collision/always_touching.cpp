#include "robots/collision/always_touching.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <random>
#include <vector>

namespace kinship::collision {
namespace {

/// Pairs of bodies that are called by one name, and in how many samples none of them touched.
struct NamedPairs {
  std::vector<BodyPair> pairs;
  int missed = 0;
};

/// The ones of `named` that always touch. One that no longer can is not looked at further: most
/// pairs miss the first samples.
template <typename Name>
std::set<Name> touching_everywhere(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                                   std::map<Name, NamedPairs> named, const TouchSamples& samples) {
  constexpr std::uint64_t kSeed = 1;
  std::mt19937_64 generator(kSeed);
  std::vector<Eigen::Isometry3d> T_base_bodies = standing_poses(bodies);
  const auto touching = [&](const BodyPair& pair) {
    const auto [a, b] = pair;
    return touch(bodies[a].solid, T_base_bodies[a], bodies[b].solid, T_base_bodies[b]);
  };
  Eigen::VectorXd q(chain.dof());
  for (int sample = 0; sample < samples.count && !named.empty(); ++sample) {
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
    place_bodies(chain, bodies, q, T_base_bodies);
    for (auto at = named.begin(); at != named.end();) {
      NamedPairs& now = at->second;
      now.missed += std::ranges::any_of(now.pairs, touching) ? 0 : 1;
      at = now.missed > samples.count - samples.least ? named.erase(at) : std::next(at);
    }
  }
  std::set<Name> always;
  for (const auto& [name, pairs] : named)
    always.insert(name);
  return always;
}

}  // namespace

LinkPairs links_always_touching(const RobotSolids::Parts& robot, const TouchSamples& samples) {
  std::map<std::pair<int, int>, NamedPairs> named;
  for (const BodyPair& pair : moving_pairs(robot.bodies, robot.unchecked, {}))
    named[std::minmax(robot.bodies[pair.first].link, robot.bodies[pair.second].link)]
        .pairs.push_back(pair);
  return touching_everywhere(robot.chain, robot.bodies, std::move(named), samples);
}

std::set<std::pair<std::string, std::string>> always_touching(const RobotSolids& robot,
                                                              const Surroundings& surroundings,
                                                              const TouchSamples& samples) {
  using Names = std::pair<std::string, std::string>;
  const std::vector<Body> bodies = bodies_among(robot, surroundings);
  const auto name_of = [&bodies](const BodyPair& pair) {
    return Names(bodies[pair.first].name, bodies[pair.second].name);
  };
  const std::vector<Eigen::Isometry3d> T_base_bodies = standing_poses(bodies);
  std::set<Names> always;
  for (const BodyPair& pair : standing_pairs(bodies, surroundings)) {
    const auto [a, b] = pair;
    if (touch(bodies[a].solid, T_base_bodies[a], bodies[b].solid, T_base_bodies[b]))
      always.insert(name_of(pair));
  }
  std::map<Names, NamedPairs> named;
  for (const BodyPair& pair : moving_pairs(bodies, robot.parts().unchecked, surroundings))
    if (Names name = name_of(pair); !always.contains(name))
      named[std::move(name)].pairs.push_back(pair);
  always.merge(touching_everywhere(robot.parts().chain, bodies, std::move(named), samples));
  return always;
}

}  // namespace kinship::collision
