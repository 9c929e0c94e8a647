#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace kinship {

/// A Gaussian mixture over configurations: K components in d dimensions, joint units. Each has its
/// own covariance, or all share one: then it is a kernel density estimate and components are
/// kernels.
///
/// Invariant: K >= 1, d >= 1; weights non-negative, sum 1 within 1e-6 (normalised unless within
/// 1e-12); every value finite; covariances d x d and symmetric within 1e-9 of their largest entry
/// (then made exactly symmetric). Positive definiteness is checked where a factor is needed.
class Mixture {
 public:
  /// \param weights      K.
  /// \param means        d x K, one column per component.
  /// \param covariances  K matrices d x d, or one for all.
  /// \throws std::invalid_argument if the invariant does not hold.
  Mixture(Eigen::VectorXd weights, Eigen::MatrixXd means, std::vector<Eigen::MatrixXd> covariances);

  Eigen::Index size() const noexcept { return weights_.size(); }     ///< number of components K
  Eigen::Index dimension() const noexcept { return means_.rows(); }  ///< d
  const Eigen::VectorXd& weights() const noexcept { return weights_; }
  const Eigen::MatrixXd& means() const noexcept { return means_; }
  /// K of them, or one if it is shared.
  const std::vector<Eigen::MatrixXd>& covariances() const noexcept { return covariances_; }
  /// Whether two or more components share one covariance.
  bool shares_covariance() const noexcept { return size() > 1 && covariances_.size() == 1; }
  /// Index in covariances() of component k.
  std::size_t covariance_index(Eigen::Index k) const noexcept {
    return covariances_.size() == 1 ? 0 : static_cast<std::size_t>(k);
  }
  const Eigen::MatrixXd& covariance(Eigen::Index k) const {
    return covariances_[covariance_index(k)];
  }

 private:
  Eigen::VectorXd weights_;
  Eigen::MatrixXd means_;
  std::vector<Eigen::MatrixXd> covariances_;
};

}  // namespace kinship
