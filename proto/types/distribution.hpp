#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// What one source robot contributed to a distribution.
struct Source {
  Digest robot;
  std::string label;
  std::uint64_t paths = 0;
  std::uint64_t generation = 0;    ///< of (robot, task) when the fit read it
  std::uint64_t poses = 0;         ///< after resampling
  std::uint64_t poses_solved = 0;  ///< with at least one configuration of the target
};

/// Ready: there is a mixture. Failed: nothing could be transferred or fitted; `reason` says why.
enum class DistributionState { Ready, Failed };

/// A mixture fitted for one robot and task, with its provenance.
struct Distribution {
  Digest id;                   ///< digest of the key: task, robot, placement, parameters, engines
  std::uint64_t revision = 0;  ///< durable counter per id
  Uuid store_epoch;
  std::string task;
  Digest robot;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< snapped
  std::string profile;
  std::string engines;  ///< versions of the transfer and density code, e.g. "transfer 1, density 1"
  DistributionState state = DistributionState::Ready;
  std::string reason;  ///< why Failed; a warning otherwise, mostly empty
  std::vector<Source> sources;
  std::uint64_t configurations = 0;  ///< number the mixture was fitted to
  std::optional<Mixture> mixture;    ///< present exactly if Ready
  Eigen::Matrix2Xd limits;           ///< 2 x dof: lower, upper; joint units
  std::optional<double> held_out_score;
  double recommended_share = 0;  ///< of guided samples
  std::string evidence;          ///< for the share, in words
  std::int64_t fitted_ms = 0;    ///< Unix time, UTC
  double transfer_time_s = 0;
  double fit_time_s = 0;
};

}  // namespace kinship
