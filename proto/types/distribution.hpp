#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/advice.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/fit_origin.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/selection.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// How a source robot is related to the target.
enum class Relation {
  Other,      ///< another arm: by inverse kinematics
  SameArm,    ///< the same arm within tolerance: waypoints taken over and polished
  Identical,  ///< the same kinematics, or the robot itself: waypoints taken over as they are
};

/// What one source robot contributed to a distribution.
struct Source {
  Digest robot;
  std::string label;
  std::uint64_t paths = 0;         ///< of (robot, task) when the fit read it
  std::uint64_t generation = 0;    ///< of (robot, task) when the fit read it
  std::uint64_t poses = 0;         ///< after resampling
  std::uint64_t poses_solved = 0;  ///< with at least one configuration of the target
  Relation relation = Relation::Other;
  std::uint64_t paths_used = 0;    ///< read and transferred; fewer than `paths` by `since`, a cap
  std::uint64_t out_of_reach = 0;  ///< poses without a solution, by reason
  std::uint64_t outside_limits = 0;
  std::uint64_t not_converged = 0;
  std::uint64_t configurations = 0;  ///< its poses became
  double mass = 0;                   ///< its share of the weight of all configurations, 0 to 1
  std::uint64_t colliding = 0;       ///< poses whose every configuration a filter left out
  std::uint64_t tracks_tried = 0;    ///< along its paths
  std::uint64_t tracks_kept = 0;     ///< that cover enough of their path
  /// Of `configurations`: found for one pose alone, neither along a track nor taken over.
  std::uint64_t random_configurations = 0;
  std::uint64_t filter_checks = 0;     ///< configurations that the filters were asked about
  std::uint64_t self_collisions = 0;   ///< of them left out: the target touches itself
  std::uint64_t scene_collisions = 0;  ///< of them left out: it touches the recorded scene
  std::uint64_t paths_with_scene = 0;  ///< of `paths_used`: filtered by their recorded scene
  /// Of `tracks_tried`: came through the whole path. The share of the target's solutions that
  /// continue through the paths.
  std::uint64_t tracks_through = 0;
};

/// How well a number of components does at configurations of paths that were held out.
struct ComponentScore {
  int components = 0;
  /// Weighted mean over held-out configurations of log(0.99 p + 0.01 u), nats: p the density of the
  /// mixture of the other paths, u that of the uniform distribution within the limits.
  double score = 0;

  bool operator==(const ComponentScore&) const = default;
};

/// Ready: there is a mixture. Failed: nothing could be transferred or fitted; `reason` says why.
/// Thin: there is a mixture, made of a small part of the experience (server/service says how
/// small).
enum class DistributionState { Ready, Failed, Thin };

/// Whether a distribution of this state has a mixture.
constexpr bool has_mixture(DistributionState state) { return state != DistributionState::Failed; }

/// A mixture fitted for one robot and task, with its provenance.
struct Distribution {
  Digest id;                   ///< digest of the key: task, robot, placement, parameters, engines
  std::uint64_t revision = 0;  ///< durable counter per id
  Uuid store_epoch;
  std::string task;
  Digest robot;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< snapped
  std::string profile;
  Selection selection;  ///< sources and since as asked; weighting as used
  std::string engines;  ///< versions of the transfer and density code, e.g. "transfer 1, density 1"
  DistributionState state = DistributionState::Ready;
  std::string reason;  ///< why Failed; a warning otherwise, mostly empty
  std::vector<Source> sources;
  std::uint64_t configurations = 0;  ///< number the mixture was fitted to
  std::optional<Mixture> mixture;    ///< present exactly unless Failed
  Eigen::Matrix2Xd limits;           ///< 2 x dof: lower, upper; joint units
  /// Where the number of components was chosen: the highest score of `component_scores`. Both are
  /// those of the last full fit.
  std::optional<double> held_out_score;
  /// Of the moment it was sent, not of the fit.
  Advice advice;
  std::int64_t fitted_ms = 0;  ///< Unix time, UTC
  double transfer_time_s = 0;
  double fit_time_s = 0;
  std::vector<ComponentScore> component_scores;  ///< falling number of components; mostly empty
  /// Per joint, where the circle of a continuous one is cut: means and limits lie in
  /// [cut, cut + 2 pi]. Empty if no joint is continuous.
  std::vector<std::optional<double>> cuts;
  std::optional<FitOrigin> fit;  ///< of its mixture; missing in what older servers stored
};

}  // namespace kinship
