#include "robots/planning/guided_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "proto/mixture/cholesky.hpp"
#include "proto/types/turn.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::planning {
namespace {

/// Measures many configurations against one mixture.
class MahalanobisDistance {
 public:
  MahalanobisDistance(const kinematics::Chain& chain, const Mixture& mixture)
      : mixture_(mixture),
        factors_(mixture::cholesky_factors(widened(mixture))),
        turning_(turning_joints(chain)) {}

  /// Squared, to the nearest component.
  double operator()(const Eigen::Ref<const Eigen::VectorXd>& q) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < mixture_.size(); ++k) {
      Eigen::VectorXd offset = q - mixture_.means().col(k);
      for (Eigen::Index i = 0; i < offset.size(); ++i)
        if (turning_[static_cast<std::size_t>(i)])
          offset[i] = wrapped(offset[i]);
      factors_[mixture_.covariance_index(k)].triangularView<Eigen::Lower>().solveInPlace(offset);
      nearest = std::min(nearest, offset.squaredNorm());
    }
    return nearest;
  }

 private:
  const Mixture& mixture_;
  const std::vector<Eigen::MatrixXd> factors_;  // lower Cholesky factors, d x d, of covariances()
  const std::vector<bool> turning_;
};

/// How much of its part a mixture gets, 0 to 1: all up to the gate's distance.
double trust(const kinematics::Chain& chain, const TrackQuery& query, const Mixture& mixture,
             double gate_distance) {
  constexpr double kLeast = 0.01;
  const QueryDistance distance = query_distance(chain, mixture, query.start, query.goals);
  const double ratio = gate_distance / std::max(distance.start, distance.goal);
  if (!(ratio < 1))
    return 1;
  return ratio * ratio < kLeast ? 0 : ratio * ratio;
}

/// A guide's shares of the guided samples, each 0 to 1, and the number of its retreats. Chosen on
/// tuning instances of the studies (docs/decisions/planning.md).
struct Parts {
  std::size_t retreats = 0;
  double tracks = 0;
  double mixture = 0;
};

/// Recall takes no samples.
Parts parts_of(Guide guide) {
  constexpr std::size_t kAllGoals = 40, kNearestGoals = 3;
  switch (without_recall(guide)) {
    case Guide::None:
      break;
    case Guide::Retreat:
      return {kAllGoals, 0.5, 0};
    case Guide::Ways:
      return {0, 0.9, 0};
    case Guide::RetreatWays:
      return {kNearestGoals, 0.8, 0};
    case Guide::Mixture:
      return {0, 0, 1};
    case Guide::RetreatMixture:
      return {kAllGoals, 0.3, 0.3};
    case Guide::WaysMixture:
      return {0, 0.1, 0.8};
    case Guide::RetreatWaysMixture:
      return {kNearestGoals, 0.5, 0.2};
    default:
      break;
  }
  return {};
}

}  // namespace

Mixture widened(const Mixture& mixture) {
  std::vector<Eigen::MatrixXd> covariances = mixture.covariances();
  for (Eigen::MatrixXd& covariance : covariances)
    covariance.diagonal().array() += kGateVariance;
  return Mixture(mixture.weights(), mixture.means(), std::move(covariances));
}

QueryDistance query_distance(const kinematics::Chain& chain, const Mixture& mixture,
                             const Eigen::Ref<const Eigen::VectorXd>& start,
                             const Eigen::Ref<const Eigen::MatrixXd>& goals) {
  if (mixture.dimension() != chain.dof() || start.size() != chain.dof() ||
      goals.rows() != chain.dof())
    throw std::invalid_argument("query_distance: chain, mixture, start and goals differ in size");
  const MahalanobisDistance distance_to(chain, mixture);
  QueryDistance distance{distance_to(start), std::numeric_limits<double>::infinity()};
  for (const auto& goal : goals.colwise())
    distance.goal = std::min(distance.goal, distance_to(goal));
  return distance;
}

GuidedSampler guided_sampler(const kinematics::Chain& chain, const TrackQuery& query,
                             const Mixture* mixture,
                             std::shared_ptr<const ExperienceGuide> experience,
                             const GuideOptions& options) {
  Parts parts = parts_of(options.guide);
  if (experience == nullptr && parts.mixture > 0)
    parts = parts_of(Guide::Mixture);
  GuidedSampler guided{ConfigurationSampler(query.bounds)};
  const double mixture_part = options.guided_fraction * parts.mixture;
  if (mixture != nullptr && mixture_part > 0) {
    const double part = trust(chain, query, *mixture, options.gate_distance);
    guided.gate_fired = part < 1;
    guided.mixture_share = part * mixture_part;
    if (guided.mixture_share > 0)
      guided.sampler = ConfigurationSampler(query.bounds, chain, *mixture, guided.mixture_share);
  }
  guided.track_share = experience != nullptr ? options.guided_fraction * parts.tracks : 0;
  if (guided.track_share > 0) {
    TrackOptions tracks = options.tracks;
    tracks.retreats = parts.retreats;
    if (!has_ways(options.guide))
      tracks.paths = 0;
    guided.sampler = guided.sampler.with_tracks(
        std::make_shared<QueryTracks>(std::move(experience), query, tracks), guided.track_share);
  }
  return guided;
}

}  // namespace kinship::planning
