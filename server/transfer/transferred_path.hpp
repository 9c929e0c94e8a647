#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "robots/inverse/inverse.hpp"

namespace kinship::transfer {

/// How a path fared: poses after resampling, and what became of them. Every pose is counted once:
/// poses = poses_solved + out_of_reach + outside_limits + not_converged.
struct TransferSummary {
  std::uint64_t poses = 0;
  std::uint64_t poses_solved = 0;
  std::uint64_t out_of_reach = 0;
  std::uint64_t outside_limits = 0;
  std::uint64_t not_converged = 0;
  std::uint64_t configurations = 0;

  /// Counts one pose.
  /// \param found   configurations of the target for it.
  /// \param reason  why there is none.
  void count(Eigen::Index found, inverse::NoSolution reason);

  void add(const TransferSummary& other);
};

/// Configurations of the target robot that one path of a source robot became.
struct TransferredPath {
  Eigen::MatrixXd configurations;  ///< target dof x n, n >= 0
  Eigen::VectorXi pose_index;      ///< n: the resampled pose a configuration belongs to
  Eigen::VectorXi solution_index;  ///< n: among the solutions of that pose
  Eigen::VectorXd weights;  ///< n: all 1; who pools paths divides so that paths weigh the same
  TransferSummary summary;
};

}  // namespace kinship::transfer
