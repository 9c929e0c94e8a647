#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "robots/inverse/inverse.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/uncovered_poses.hpp"

namespace kinship::transfer {

/// How a path fared: poses after resampling, and what became of them. Every pose is counted once:
/// poses = poses_solved + out_of_reach + outside_limits + not_converged + colliding.
struct TransferSummary {
  std::uint64_t poses = 0;
  std::uint64_t poses_solved = 0;
  std::uint64_t out_of_reach = 0;
  std::uint64_t outside_limits = 0;
  std::uint64_t not_converged = 0;
  std::uint64_t colliding = 0;  ///< there were configurations, but the filters left out each
  std::uint64_t configurations = 0;
  std::uint64_t random_configurations = 0;  ///< of them, found for one pose alone
  std::uint64_t tracks_tried = 0, tracks_kept = 0;
  /// Of those tried, how many came through the whole path: divided by tracks_tried, the share of
  /// the target's solutions that continue through it.
  std::uint64_t tracks_through = 0;
  std::uint64_t filter_checks = 0;  ///< configurations that the filters were asked about
  std::uint64_t self_collisions = 0, scene_collisions = 0;  ///< of them left out

  /// Counts one pose.
  /// \param found   configurations of the target for it.
  /// \param reason  why there is none.
  void count(Eigen::Index found, inverse::NoSolution reason);

  /// Counts one pose for which random solutions were looked for.
  void count(const RandomSolutions& random);

  /// Takes over what the filters counted.
  void set(const CountedFilters& filters);

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
