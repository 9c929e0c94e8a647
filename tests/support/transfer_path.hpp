#pragma once

#include <cstdint>
#include <utility>

#include "server/transfer/transfer.hpp"

namespace kinship::test {

/// A path in a group of its own; see transfer_paths.
inline transfer::TransferredPath transfer_path(const Path& path, const transfer::ArmPair& pair,
                                               const Eigen::Isometry3d& T_target_source,
                                               const TransferParameters& parameters,
                                               std::uint64_t seed,
                                               const transfer::Filters& filters = {}) {
  const transfer::PathToTransfer alone{path, T_target_source, filters};
  return std::move(transfer::transfer_paths({&alone, 1}, pair, parameters, seed).front());
}

}  // namespace kinship::test
