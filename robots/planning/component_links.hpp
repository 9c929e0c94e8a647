#pragma once

#include <Eigen/Core>
#include <vector>

#include "robots/planning/configuration_sampler.hpp"

/// Which components of a mixture are close; for this library's sources only.
namespace kinship::planning {

/// The components of a sampler's mixture, their means moved into its bounds where a turn fits.
class ComponentShapes {
 public:
  /// \param sampler  with a mixture.
  explicit ComponentShapes(const ConfigurationSampler& sampler);

  Eigen::Index size() const noexcept { return means_.cols(); }
  Eigen::VectorXd mean(Eigen::Index k) const { return means_.col(k); }
  const Eigen::MatrixXd& factor(Eigen::Index k) const { return factors_[index(k)]; }

  /// Squared Mahalanobis distance per joint, the component's variances widened by kGateVariance.
  double doubt(Eigen::Index k, const Eigen::VectorXd& q) const;
  double min_doubt(const Eigen::VectorXd& q) const;

  /// Pairs (i < j) of close components, see plan_roadmap.
  std::vector<std::pair<Eigen::Index, Eigen::Index>> links(int neighbours) const;

 private:
  /// Of component k among covariances and their factors.
  std::size_t index(Eigen::Index k) const noexcept {
    return factors_.size() == 1 ? 0 : static_cast<std::size_t>(k);
  }
  double bhattacharyya_distance(Eigen::Index i, Eigen::Index j) const;

  Eigen::MatrixXd means_;
  std::vector<Eigen::MatrixXd> covariances_;
  std::vector<Eigen::MatrixXd> factors_, widened_factors_;  // lower Cholesky factors
};

}  // namespace kinship::planning
