#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/profile.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/path_poses.hpp"

namespace kinship::transfer {

/// Configurations of the target robot for consecutive poses of a path, without a jump.
struct Track {
  Eigen::Index first_pose = 0;
  Eigen::MatrixXd configurations;  ///< dof x n, n >= 1, each as `inverse` would give it
};

/// Follows a path of the source robot with the target robot: a random pose of the path, there the
/// configuration that looks most like the source's, and from it pose by pose to both ends, each
/// from the one before, everywhere pulled through the self-motion towards the source's shape. A
/// redundant arm so takes the path in one posture, the source's, instead of one per pose.
///
/// A step ends the track if the pose is not reached within the limits, if the target would move
/// more than kMostMotion times as far as the source and kSpareMotion (joint units), or if a filter
/// says no. Deterministic: depends on the seed and on what it is given. Not shared between threads.
class ShapeTracker {
 public:
  static constexpr double kMostMotion = 3;
  static constexpr double kSpareMotion = 0.3;
  static constexpr int kTriesPerTrack = 6;

  /// \param pair, poses, parameters, filters  outlive it.
  ShapeTracker(const ArmPair& pair, const PathPoses& poses, const TransferParameters& parameters,
               std::uint64_t seed, CountedFilters& filters);

  /// Up to parameters.tracks tracks that cover at least parameters.least_coverage of the poses.
  /// Gives up after kTriesPerTrack tries in a row that brought none.
  std::vector<Track> find_tracks();

  std::uint64_t tried() const noexcept { return tried_; }

 private:
  std::optional<Track> try_track();
  const Eigen::MatrixXd& candidates(Eigen::Index pose);
  /// \return a column of the candidates of a pose; -1: there are none.
  Eigen::Index choose_start(Eigen::Index pose);
  /// The candidate, pulled towards the source's shape if filters allow where it gets to.
  Eigen::VectorXd pulled_start(Eigen::Index pose, const Eigen::VectorXd& candidate);
  /// Moves `q` from one pose to its neighbour. \return whether it got there.
  bool follow(Eigen::Index from, Eigen::Index to, inverse::JointVector& q,
              Eigen::Ref<Eigen::VectorXd> found);
  double normal();

  const ArmPair& pair_;
  const PathPoses& poses_;
  const TransferParameters& parameters_;
  const std::uint64_t seed_;
  CountedFilters& filters_;
  inverse::CounterGenerator generator_;
  std::vector<std::optional<Eigen::MatrixXd>> candidates_;  // of each pose; missing: not asked yet
  std::uint64_t tried_ = 0;
};

}  // namespace kinship::transfer
