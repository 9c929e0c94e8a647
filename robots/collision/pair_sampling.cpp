#include "robots/collision/pair_sampling.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <random>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/lane_world.hpp"

namespace kinship::collision {
namespace {

// So many configurations tell which pairs touch often: these are asked one by one from then on, for
// lanes that find one contact do not find the others.
constexpr std::uint64_t kFirst = 128;
constexpr double kOften = 0.02;

/// The pairs of bodies of two links.
struct LinkPair {
  SampledPair sampled;
  std::vector<BodyPair> bodies;
};

/// Nearest links with solids that have no other one between them.
LinkPairs adjacent_links(const kinematics::Chain& chain, const std::vector<bool>& has_solid) {
  LinkPairs adjacent;
  for (std::size_t link = 0; link < chain.links().size(); ++link) {
    if (!has_solid[link])
      continue;
    int above = chain.links()[link].parent;
    while (above >= 0 && !has_solid[static_cast<std::size_t>(above)])
      above = chain.links()[static_cast<std::size_t>(above)].parent;
    if (above >= 0)
      adjacent.emplace(std::minmax(above, static_cast<int>(link)));
  }
  return adjacent;
}

std::vector<LinkPair> pairs_of(const kinematics::Chain& chain, const std::vector<Body>& bodies) {
  std::vector<bool> has_solid(chain.links().size(), false);
  for (const Body& body : bodies)
    has_solid[static_cast<std::size_t>(body.link)] = true;
  const LinkPairs adjacent = adjacent_links(chain, has_solid);
  std::map<std::pair<int, int>, LinkPair> pairs;
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      const std::pair<int, int> links = std::minmax(bodies[a].link, bodies[b].link);
      const bool is_adjacent = adjacent.contains(links);
      if (links.first == links.second || (!is_adjacent && bodies[a].joint == bodies[b].joint))
        continue;
      LinkPair& pair = pairs[links];
      pair.sampled = {.link_a = links.first, .link_b = links.second, .is_adjacent = is_adjacent};
      pair.bodies.emplace_back(a, b);
    }
  std::vector<LinkPair> all;
  for (auto& [links, pair] : pairs)
    all.push_back(std::move(pair));
  return all;
}

class Sampling {
 public:
  Sampling(const kinematics::Chain& chain, const geometry::RobotShapes& shapes)
      : chain_(chain),
        bodies_(link_bodies(chain, shapes)),
        pairs_(pairs_of(chain, bodies_)),
        T_base_bodies_(standing_poses(bodies_)) {}

  void look_at_zero() {
    place_bodies(
        chain_, bodies_,
        Eigen::VectorXd::Zero(chain_.dof()).cwiseMax(chain_.lower()).cwiseMin(chain_.upper()),
        T_base_bodies_);
    for (LinkPair& pair : pairs_)
      pair.sampled.touches_at_zero = is_touching(pair);
  }

  void sample(const PairSamplingOptions& options) {
    std::mt19937_64 generator(options.seed);
    const std::uint64_t first = std::min(kFirst, options.samples);
    std::vector<LinkPair*> all;
    for (LinkPair& pair : pairs_)
      all.push_back(&pair);
    for (std::uint64_t i = 0; i < first; ++i)
      ask_each(all, next(generator));
    sort_by_frequency(first);
    LaneWorld lanes(chain_, bodies_, bodies_of(seldom_));
    std::uint64_t done = first;
    while (done < options.samples) {
      const auto count =
          static_cast<Eigen::Index>(std::min<std::uint64_t>(kLanes, options.samples - done));
      Eigen::MatrixXd qs(chain_.dof(), count);
      for (Eigen::Index lane = 0; lane < count; ++lane)
        qs.col(lane) = next(generator);
      ask_together(lanes, qs);
      done += static_cast<std::uint64_t>(count);
      options.progress(static_cast<double>(done) / static_cast<double>(options.samples));
    }
  }

  std::vector<SampledPair> found() const {
    std::vector<SampledPair> found;
    for (const LinkPair& pair : pairs_)
      found.push_back(pair.sampled);
    return found;
  }

 private:
  Eigen::VectorXd next(std::mt19937_64& generator) const {
    Eigen::VectorXd q(chain_.dof());
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] =
          std::uniform_real_distribution<double>(chain_.lower()[i], chain_.upper()[i])(generator);
    return q;
  }

  bool is_touching(const LinkPair& pair) const {
    return std::ranges::any_of(pair.bodies, [&](const BodyPair& bodies) {
      const auto [a, b] = bodies;
      return touch(bodies_[a].solid, T_base_bodies_[a], bodies_[b].solid, T_base_bodies_[b]);
    });
  }

  void ask_each(const std::vector<LinkPair*>& pairs, const Eigen::VectorXd& q) {
    place_bodies(chain_, bodies_, q, T_base_bodies_);
    for (LinkPair* const pair : pairs)
      pair->sampled.touched += is_touching(*pair) ? 1U : 0U;
  }

  /// Lanes take bodies that move each other only.
  void sort_by_frequency(std::uint64_t samples) {
    for (LinkPair& pair : pairs_) {
      const auto [a, b] = pair.bodies.front();
      const bool is_often =
          static_cast<double>(pair.sampled.touched) > kOften * static_cast<double>(samples);
      (is_often || bodies_[a].joint == bodies_[b].joint ? often_ : seldom_).push_back(&pair);
    }
  }

  static std::vector<BodyPair> bodies_of(const std::vector<LinkPair*>& pairs) {
    std::vector<BodyPair> bodies;
    for (const LinkPair* const pair : pairs)
      bodies.insert(bodies.end(), pair->bodies.begin(), pair->bodies.end());
    return bodies;
  }

  /// FCL answers where the lanes leave a doubt.
  void ask_together(LaneWorld& lanes, const Eigen::MatrixXd& qs) {
    const std::uint32_t maybe = seldom_.empty() ? 0 : lanes.ask(qs).maybe;
    for (Eigen::Index lane = 0; lane < qs.cols(); ++lane) {
      ask_each(often_, qs.col(lane));
      if (((maybe >> static_cast<unsigned>(lane)) & 1U) != 0)
        for (LinkPair* const pair : seldom_)
          pair->sampled.touched += is_touching(*pair) ? 1U : 0U;
    }
  }

  const kinematics::Chain& chain_;
  const std::vector<Body> bodies_;
  std::vector<LinkPair> pairs_;
  std::vector<LinkPair*> often_, seldom_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;
};

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

std::vector<SampledPair> sample_pairs(const kinematics::Chain& chain,
                                      const geometry::RobotShapes& shapes,
                                      const PairSamplingOptions& options) {
  Sampling sampling(chain, shapes);
  sampling.look_at_zero();
  sampling.sample(options);
  return sampling.found();
}

LinkPairs links_always_touching(const RobotSolids::Parts& robot, const TouchSamples& samples) {
  std::map<std::pair<int, int>, NamedPairs> named;
  for (const BodyPair& pair :
       moving_pairs(robot.bodies, checked_links(robot.bodies, robot.unchecked), {}))
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
  for (const BodyPair& pair : moving_pairs(bodies, robot.parts().checked, surroundings))
    if (Names name = name_of(pair); !always.contains(name))
      named[std::move(name)].pairs.push_back(pair);
  always.merge(touching_everywhere(robot.parts().chain, bodies, std::move(named), samples));
  return always;
}

}  // namespace kinship::collision
