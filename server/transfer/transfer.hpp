#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "proto/types/path.hpp"
#include "proto/types/profile.hpp"
#include "robots/kinematics/chain.hpp"

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
};

/// Configurations of the target robot that one path of a source robot became.
struct TransferredPath {
  Eigen::MatrixXd configurations;  ///< target dof x n, n >= 0
  Eigen::VectorXi pose_index;      ///< n: the resampled pose a configuration belongs to
  Eigen::VectorXi solution_index;  ///< n: among the solutions of that pose
  Eigen::VectorXd weights;  ///< n: all 1; who pools paths divides so that paths weigh the same
  TransferSummary summary;
};

/// Moves one path of the source robot into the configuration space of the target robot: forward
/// kinematics to the transfer frame, then up to L inverse solutions a pose at least d apart.
/// If the digests are equal and T_target_source is the identity (within 1e-9), the resampled
/// waypoints are taken over: one configuration a pose, with solution_index 0, as they are but for
/// continuous joints, which are turned into [-pi, pi].
/// The task axes that matter are the target robot's.
///
/// \param T_target_source  pose of the source robot's base in the target robot's base:
///                         T_task_target^-1 * T_task_source.
/// \param seed             equal input and seed: equal bytes. A pose's solutions depend on the seed
///                         and that pose only, not on the path around it.
/// \throws std::invalid_argument if path.dof() != source.dof(), or `parameters` break the rules of
///         `resample` or of `inverse::InverseOptions`.
/// Source: Lehner et al., ICRA 2022, section IV A.
TransferredPath transfer_path(const Path& path, const kinematics::Chain& source,
                              const kinematics::Chain& target,
                              const Eigen::Isometry3d& T_target_source,
                              const TransferParameters& parameters, std::uint64_t seed);

/// Version of this code; part of a distribution's key. Raised when its output changes.
inline constexpr int kTransferVersion = 2;

}  // namespace kinship::transfer
