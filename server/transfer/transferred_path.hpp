#pragma once

#include <Eigen/Core>

#include "proto/types/source.hpp"
#include "robots/inverse/inverse.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/uncovered_poses.hpp"

namespace kinship::transfer {

/// Counts one pose.
/// \param found   configurations of the target for it.
/// \param reason  why there is none.
void count_pose(Eigen::Index found, inverse::NoSolution reason, TransferCounts& counts);

/// Counts one pose for which random solutions were searched.
void count_pose(const RandomSolutions& random, TransferCounts& counts);

/// Takes over the counts of the filters.
void count_filtered(const CountedFilters& filters, TransferCounts& counts);

/// Result of the transfer of one path: configurations of the target robot.
struct TransferredPath {
  Eigen::MatrixXd configurations;  ///< target dof x n, n >= 0
  Eigen::VectorXi pose_index;      ///< n: the resampled pose a configuration belongs to
  Eigen::VectorXi solution_index;  ///< n: among the solutions of that pose
  Eigen::VectorXd weights;         ///< n: all 1; pooling divides them so that paths weigh the same
  TransferCounts summary;          ///< of its poses
};

}  // namespace kinship::transfer
