#include "robots/collision/fitted_links.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>

#include "robots/collision/robot_solids.hpp"
#include "robots/geometry/known_shapes.hpp"

namespace kinship::collision {
namespace {

/// Pairs of a robot's links, and which of them touch where.
class TouchingLinks {
 public:
  TouchingLinks(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                const LinkPairs& unchecked)
      : chain_(chain),
        bodies_(link_bodies(chain, shapes)),
        pairs_(moving_pairs(bodies_, checked_links(bodies_, unchecked), {})),
        T_base_bodies_(standing_poses(bodies_)) {}

  LinkPairs at(const Eigen::VectorXd& q) {
    place_bodies(chain_, bodies_, q, T_base_bodies_);
    LinkPairs touched;
    for (const auto& [a, b] : pairs_) {
      const std::pair<int, int> links = std::minmax(bodies_[a].link, bodies_[b].link);
      if (touched.count(links) == 0 &&
          touch(bodies_[a].solid, T_base_bodies_[a], bodies_[b].solid, T_base_bodies_[b]))
        touched.insert(links);
    }
    return touched;
  }

 private:
  const kinematics::Chain& chain_;
  std::vector<Body> bodies_;
  std::vector<BodyPair> pairs_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;
};

/// One configuration, as the meshes and as the fitted shapes see it.
struct Comparison {
  bool is_free = true;  ///< no meshes touch
  LinkPairs fitted;     ///< whose fitted shapes touch
};

std::size_t count_caught(const std::vector<Comparison>& comparisons, bool free) {
  return static_cast<std::size_t>(
      std::ranges::count_if(comparisons, [free](const Comparison& comparison) {
        return comparison.is_free == free && !comparison.fitted.empty();
      }));
}

void give_up(const std::pair<int, int>& pair, std::vector<Comparison>& comparisons) {
  for (Comparison& comparison : comparisons)
    comparison.fitted.erase(pair);
}

/// The pair that costs most free configurations for each collision that it finds.
std::pair<int, int> worst_pair(const std::vector<Comparison>& comparisons) {
  std::map<std::pair<int, int>, std::pair<double, double>> counts;  // lost, found
  for (const Comparison& comparison : comparisons)
    for (const auto& pair : comparison.fitted)
      ++(comparison.is_free ? counts[pair].first : counts[pair].second);
  const auto cost = [](const auto& entry) {
    return entry.second.first / (1 + entry.second.second);
  };
  return std::ranges::max_element(counts, {}, cost)->first;
}

std::vector<Eigen::VectorXd> random_configurations(const kinematics::Chain& chain, int samples) {
  constexpr std::uint64_t kSeed = 1;
  std::mt19937_64 generator(kSeed);
  std::vector<Eigen::VectorXd> configurations;
  Eigen::VectorXd q(chain.dof());
  for (int sample = 0; sample < samples; ++sample) {
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
    configurations.push_back(q);
  }
  return configurations;
}

}  // namespace

FilterAgreement choose_filtered_pairs(const kinematics::Chain& chain,
                                      const geometry::RobotShapes& exact,
                                      const geometry::RobotShapes& fitted,
                                      const AgreementOptions& options) {
  LinkPairs unfiltered = RobotSolids(chain, exact).parts().unchecked;
  TouchingLinks meshes(chain, exact, unfiltered), solids(chain, fitted, unfiltered);
  const auto compare = [&](const Eigen::VectorXd& q) {
    return Comparison{meshes.at(q).empty(), solids.at(q)};
  };
  std::vector<Comparison> comparisons;
  for (const Eigen::VectorXd& q : random_configurations(chain, options.samples))
    comparisons.push_back(compare(q));
  const Comparison zero =
      compare(Eigen::VectorXd::Zero(chain.dof()).cwiseMax(chain.lower()).cwiseMin(chain.upper()));
  if (zero.is_free)
    for (const auto& pair : zero.fitted) {
      unfiltered.insert(pair);
      give_up(pair, comparisons);
    }
  FilterAgreement agreement;
  agreement.free =
      static_cast<std::size_t>(std::ranges::count_if(comparisons, &Comparison::is_free));
  agreement.colliding = comparisons.size() - agreement.free;
  const auto may_lose = options.max_lost * static_cast<double>(agreement.free);
  while (static_cast<double>(count_caught(comparisons, true)) > may_lose) {
    const std::pair<int, int> worst = worst_pair(comparisons);
    unfiltered.insert(worst);
    give_up(worst, comparisons);
  }
  agreement.lost = count_caught(comparisons, true);
  agreement.found = count_caught(comparisons, false);
  agreement.unfiltered.assign(unfiltered.begin(), unfiltered.end());
  return agreement;
}

Result<FittedRobot> fit_robot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  FittedRobot fitted;
  auto mesh_solids = geometry::cover_links(shapes, chain);
  if (!mesh_solids)
    return mesh_solids.error();
  fitted.mesh_solids = *std::move(mesh_solids);
  if (fitted.mesh_solids.solids.empty())
    return fitted;
  const geometry::RobotShapes solids = geometry::with_solids(shapes, fitted.mesh_solids, chain);
  fitted.agreement = choose_filtered_pairs(chain, shapes, solids);
  // Pairs that every checker knows by itself, or the description has, need not be added again.
  const LinkPairs known = unchecked_links(link_bodies(chain, solids), chain, solids);
  const auto name = [&](int link) { return chain.links()[static_cast<std::size_t>(link)].name; };
  for (const auto& pair : fitted.agreement.unfiltered)
    if (!known.contains(pair))
      fitted.mesh_solids.unfiltered.emplace_back(name(pair.first), name(pair.second));
  return fitted;
}

}  // namespace kinship::collision
