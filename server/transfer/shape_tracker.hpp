#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/profile.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/descent.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/path_poses.hpp"

namespace kinship::transfer {

/// Configurations of the target robot for consecutive poses of a path, without a jump.
struct Track {
  Eigen::Index first_pose = 0;
  Eigen::MatrixXd configurations;  ///< dof x n, n >= 1, each as `inverse` would give it
};

/// What a try of a tracker is made of: the pull where the try starts, or the way from there to
/// one end of the path, pose by pose.
struct TrackExtension {
  std::size_t of_round = 0;    ///< the try, by its place in the tracker's round
  Eigen::Index direction = 0;  ///< 1 or -1: to an end of the path; 0: the pull at the start
  Eigen::Index pose = 0;       ///< where it is
  inverse::JointVector q;      ///< there, as the lanes have it: a joint may be turns away
  int unasked = 0;             ///< so many of its last poses filters have not been asked about
};

/// Follows a path of the source robot with the target robot: a random pose of the path, there the
/// configuration that looks most like the source's, and from it pose by pose to both ends, each
/// from the one before, everywhere pulled through the self-motion towards the source's shape. A
/// redundant arm so takes the path in one posture, the source's, instead of one per pose.
///
/// A step ends the track if the pose is not reached within the limits, if the target would move
/// more than kMaxMotion times as far as the source and kSpareMotion (joint units), or if a filter
/// says no. Deterministic: depends on the seed and on what it is given. Not shared between threads.
///
/// Tries are made in rounds: as many as would be made one after the other whatever comes of them.
/// The tracker draws where they start and judges what came of them; who runs their extensions
/// (ExtensionPool, together with those of other paths) tells it where they came to and when they
/// ended.
class ShapeTracker {
 public:
  static constexpr double kMaxMotion = 3;
  static constexpr double kSpareMotion = 0.3;
  static constexpr int kTriesPerTrack = 6;

  /// \param pair, poses, parameters, filters  outlive it.
  ShapeTracker(const ArmPair& pair, const PathPoses& poses, const TransferParameters& parameters,
               std::uint64_t seed, CountedFilters& filters);
  ShapeTracker(const ShapeTracker&) = delete;  // a pool points to it
  ShapeTracker& operator=(const ShapeTracker&) = delete;

  /// What the extensions brought so far: up to parameters.tracks tracks that cover at least
  /// parameters.least_coverage of the poses. After kTriesPerTrack tries in a row that brought none
  /// there are no more.
  const std::vector<Track>& tracks() const noexcept { return tracks_; }
  std::uint64_t tried() const noexcept { return tried_; }
  /// Tries whose track came through the whole path.
  std::uint64_t came_through() const noexcept { return came_through_; }

  /// The extensions with which the next tries begin. None: there is nothing left to try.
  std::vector<TrackExtension> begin_round();
  /// Moves an extension on to where it found `found` (`q` as the lanes have it). Filters are asked
  /// about some poses together: what lies behind the first that they leave out was found in vain.
  /// \return whether it may go on: filters have not said no.
  bool take(TrackExtension& extension, const inverse::JointVector& q,
            const Eigen::Ref<const Eigen::VectorXd>& found);
  /// \return what is to be extended because this extension has ended: both ways from where a try
  ///         starts, or the next round.
  std::vector<TrackExtension> end(TrackExtension& extension);
  /// Whether nothing of what was begun is under way: after end() that nothing is left to try.
  bool is_idle() const noexcept { return extensions_left_ == 0; }
  const PathPoses& poses() const noexcept { return poses_; }
  /// How far the target may move on the next step of an extension.
  double most_motion(const TrackExtension& extension) const;
  int steps() const noexcept { return parameters_.shape_steps; }  ///< of the pull at a pose
  int start_steps() const noexcept;                               ///< where a try starts

 private:
  /// Where a try begins, and how far it has come to both ends.
  struct Try {
    Eigen::Index start = 0;            // pose
    Eigen::Index first = 0, last = 0;  // poses
    Eigen::MatrixXd along;             // dof x poses; columns first to last. Empty: no start
  };
  /// Where a track may start at a pose.
  struct Candidates {
    Eigen::MatrixXd configurations;  // dof x n, n >= 0
    Eigen::VectorXd distances_m;     // n: of their shapes from the source's
  };

  Try make_try();
  /// Asks filters about the poses of an extension that they were not asked about.
  /// \return whether they keep all of them.
  bool ask(TrackExtension& extension);
  /// Keeps the tracks of the round that are long enough.
  void judge();
  const Candidates& candidates(Eigen::Index pose);
  /// \return a column of the candidates of a pose; -1: there are none.
  Eigen::Index choose_start(Eigen::Index pose);
  double normal();

  const ArmPair& pair_;
  const PathPoses& poses_;
  const TransferParameters& parameters_;
  const std::uint64_t seed_;
  CountedFilters& filters_;
  inverse::CounterGenerator generator_;
  std::vector<std::optional<Candidates>> candidates_;  // of each pose; missing: not asked yet
  std::vector<Try> round_;
  std::size_t extensions_left_ = 0;  // of the round
  int idle_ = 0;                     // tries in a row that brought no track
  std::vector<Track> tracks_;
  std::uint64_t tried_ = 0, came_through_ = 0;
};

}  // namespace kinship::transfer
