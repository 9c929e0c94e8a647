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

/// Counts one pose for which random solutions were looked for.
void count_pose(const RandomSolutions& random, TransferCounts& counts);

/// Takes over what the filters counted.
void count_filtered(const CountedFilters& filters, TransferCounts& counts);

/// Configurations of the target robot that one path of a source robot became.
struct TransferredPath {
  Eigen::MatrixXd configurations;  ///< target dof x n, n >= 0
  Eigen::VectorXi pose_index;      ///< n: the resampled pose a configuration belongs to
  Eigen::VectorXi solution_index;  ///< n: among the solutions of that pose
  Eigen::VectorXd weights;  ///< n: all 1; who pools paths divides so that paths weigh the same
  TransferCounts summary;   ///< of its poses
};

}  // namespace kinship::transfer
