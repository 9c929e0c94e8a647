#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "proto/types/path.hpp"
#include "proto/types/profile.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/transferred_path.hpp"

namespace kinship::transfer {

/// One of the paths of a source robot.
struct PathToTransfer {
  const Path& path;
  /// Pose of the source robot's base in the target robot's base: T_task_target^-1 * T_task_source.
  Eigen::Isometry3d T_target_source;
  /// Applied to every configuration found by inverse kinematics; rejected ones are left out and
  /// counted. Waypoints that are taken over were free on their robot and are not checked.
  const Filters& filters;
};

/// Moves paths of the source robot into the configuration space of the target robot: forward
/// kinematics to the transfer frame, then up to L inverse solutions a pose at least d apart. The
/// resampled waypoints of the same arm at the same place are taken over instead (take_over.hpp),
/// unless `parameters.take_over` is false: at most one configuration a pose, with solution_index 0.
/// The task axes that matter are the target robot's.
///
/// The result of each path is the same as alone, but faster: the kernels of inverse kinematics work
/// on several paths at once, and take the next when one has ended.
/// \param seed  equal input and seed: equal bytes. A pose's solutions depend on the seed and that
///              pose only; whether the search is exhaustive depends on the neighbouring poses
///              (uncovered_poses.hpp).
/// \return      one per path, in their order.
/// \throws std::invalid_argument if path.dof() is not that of the pair's source, or `parameters`
///         break the rules of `resample` or of `inverse::InverseOptions`; Stopped.
/// Source: Lehner et al., ICRA 2022, section IV A.
std::vector<TransferredPath> transfer_paths(std::span<const PathToTransfer> paths,
                                            const ArmPair& pair,
                                            const TransferParameters& parameters,
                                            std::uint64_t seed, const std::stop_token& stop = {});

/// Source of paths and sink of transferred paths.
struct PathStream {
  /// Valid until `done` is called for it; null: there are no more.
  std::function<const PathToTransfer*()> next;
  std::function<void(const PathToTransfer& path, TransferredPath transferred)> done;
};

/// The same for a stream of paths; `done` is called for each as it completes, so that several
/// threads may share the paths.
/// \throws as above, and exceptions of the functions; `done` is not called for paths in progress.
void transfer_stream(const PathStream& paths, const ArmPair& pair,
                     const TransferParameters& parameters, std::uint64_t seed,
                     const std::stop_token& stop = {});

/// Version of this code; part of a distribution's key. Raised when its output changes.
inline constexpr int kTransferVersion = 10;

}  // namespace kinship::transfer
