#pragma once

#include <Eigen/Core>
#include <vector>

namespace kinship {

/// A Gaussian mixture over configurations: K components in d dimensions, joint units.
///
/// Invariant: K >= 1, d >= 1; weights non-negative, sum 1 within 1e-6 (normalised unless within
/// 1e-12); every value finite; covariances d x d and symmetric within 1e-9 of their largest entry
/// (then made exactly symmetric). Positive definiteness is checked where a factor is needed.
class Mixture {
 public:
  /// \param weights      K.
  /// \param means        d x K, one column per component.
  /// \param covariances  K matrices d x d.
  /// \throws std::invalid_argument if the invariant does not hold.
  Mixture(Eigen::VectorXd weights, Eigen::MatrixXd means, std::vector<Eigen::MatrixXd> covariances);

  Eigen::Index size() const noexcept { return weights_.size(); }     ///< number of components K
  Eigen::Index dimension() const noexcept { return means_.rows(); }  ///< d
  const Eigen::VectorXd& weights() const noexcept { return weights_; }
  const Eigen::MatrixXd& means() const noexcept { return means_; }
  const std::vector<Eigen::MatrixXd>& covariances() const noexcept { return covariances_; }

 private:
  Eigen::VectorXd weights_;
  Eigen::MatrixXd means_;
  std::vector<Eigen::MatrixXd> covariances_;
};

}  // namespace kinship
