#include "robots/planning/guidance_gate.hpp"

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

}  // namespace kinship::planning
