#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/transfer/transfer.hpp"

namespace kinship::service {

/// Collects the configurations that paths became, and decides what each weighs in a fit.
/// Not shared between threads.
class PooledConfigurations {
 public:
  /// \param dof  of the target robot.
  explicit PooledConfigurations(Eigen::Index dof) : dof_(dof) {}

  /// \throws std::invalid_argument if the configurations have another number of joints, or as
  ///         many weights as configurations are not there.
  void add(transfer::TransferredPath path);

  Eigen::Index size() const noexcept { return size_; }  ///< number of configurations
  Eigen::MatrixXd configurations() const;               ///< dof x N, in the order of addition

  /// N weights with sum N. Equal path weights: those of every path with configurations sum to the
  /// same. Otherwise: as the transfer gave them, scaled.
  Eigen::VectorXd weights(bool equal_path_weights) const;

 private:
  Eigen::Index dof_;
  Eigen::Index size_ = 0;
  std::vector<transfer::TransferredPath> paths_;  // with at least one configuration
};

}  // namespace kinship::service
