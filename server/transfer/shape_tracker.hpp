#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/profile.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/joint_space.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/path_poses.hpp"
#include "server/transfer/shape_lanes.hpp"

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
  /// Tries that go on side by side: each takes two lanes, one to each end of the path.
  static constexpr int kTriesAtOnce = ShapeLanes::kCount / 2;

  /// \param pair, poses, parameters, filters  outlive it.
  ShapeTracker(const ArmPair& pair, const PathPoses& poses, const TransferParameters& parameters,
               std::uint64_t seed, CountedFilters& filters);

  /// Up to parameters.tracks tracks that cover at least parameters.least_coverage of the poses.
  /// Gives up after kTriesPerTrack tries in a row that brought none.
  std::vector<Track> find_tracks();

  std::uint64_t tried() const noexcept { return tried_; }
  /// Tries whose track came through the whole path.
  std::uint64_t came_through() const noexcept { return came_through_; }

 private:
  /// Where a try begins, and how far it has come to both ends.
  struct Try {
    Eigen::Index first = 0, last = 0;  // poses
    Eigen::MatrixXd along;             // dof x poses; columns first to last
  };
  /// One end of a try.
  struct Walker {
    std::size_t index = 0;  // of the try
    Eigen::Index direction = 1;
    Eigen::Index pose = 0;  // where it is
    inverse::JointVector q;
  };

  /// `count` tries one after the other would give the same. \return those that had a start.
  std::vector<Try> make_tries(int count);
  /// Where a track may start at a pose.
  struct Candidates {
    Eigen::MatrixXd configurations;  // dof x n, n >= 0
    Eigen::VectorXd distances_m;     // n: of their shapes from the source's
  };
  const Candidates& candidates(Eigen::Index pose);
  /// \return a column of the candidates of a pose; -1: there are none.
  Eigen::Index choose_start(Eigen::Index pose);
  /// The candidates, pulled towards the source's shape where filters allow where they get to.
  void pull_starts(std::vector<Try>& tries);
  void follow_to_both_ends(std::vector<Try>& tries);
  /// Moves the walkers to the next pose of each. \return those that got there, as lanes.
  unsigned walk(std::vector<Walker>& walkers, unsigned walking, std::vector<Try>& tries);
  void aim(int lane, Eigen::Index pose);
  double normal();

  const ArmPair& pair_;
  const PathPoses& poses_;
  const TransferParameters& parameters_;
  const std::uint64_t seed_;
  CountedFilters& filters_;
  inverse::CounterGenerator generator_;
  std::vector<std::optional<Candidates>> candidates_;  // of each pose; missing: not asked yet
  ShapeLanes lanes_;
  inverse::JointSpace space_;
  std::uint64_t tried_ = 0, came_through_ = 0;
};

}  // namespace kinship::transfer
