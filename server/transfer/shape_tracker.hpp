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

/// A part of a try of a tracker: the pull at the start of the try, or the steps from there to one
/// end of the path, pose by pose.
struct TrackExtension {
  std::size_t of_round = 0;    ///< index of the try in the tracker's round
  Eigen::Index direction = 0;  ///< 1 or -1: to an end of the path; 0: the pull at the start
  Eigen::Index pose = 0;       ///< current pose
  inverse::JointVector q;      ///< at that pose, in the lanes' values: a joint may be turns away
  int unasked = 0;             ///< number of its last poses that the filters have not checked
};

/// Follows a path of the source robot with the target robot: from a random pose of the path and the
/// configuration there whose shape is most like the source's, pose by pose to both ends, each from
/// the previous one, always pulled through the self-motion towards the source's shape. So a
/// redundant arm follows the path in one posture, the source's, instead of one per pose.
///
/// A step ends the track if the pose is not reached within the limits, if the target would move
/// more than kMaxMotion times as far as the source and kSpareMotion (joint units), or if a filter
/// rejects the configuration. Deterministic: depends on the seed and the arguments only. Not shared
/// between threads.
///
/// Tries are made in rounds: as many as would be made one after the other whatever their results.
/// The tracker draws their starts and judges their results; ExtensionPool runs their extensions,
/// together with those of other paths, and reports each step and end to the tracker.
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

  /// The tracks so far: up to parameters.tracks tracks that cover at least
  /// parameters.least_coverage of the poses. The search ends after kTriesPerTrack tries in a row
  /// without a track.
  const std::vector<Track>& tracks() const noexcept { return tracks_; }
  std::uint64_t tried() const noexcept { return tried_; }
  /// Tries whose track covers the whole path.
  std::uint64_t came_through() const noexcept { return came_through_; }

  /// The extensions with which the next tries begin. Empty: no tries are left.
  std::vector<TrackExtension> begin_round();
  /// Advances an extension by a step that found `found` (`q` in the lanes' values). Filters check
  /// some poses together: steps behind the first one they leave out are discarded. \return whether
  /// it may go on: no filter has rejected a step.
  bool take(TrackExtension& extension, const inverse::JointVector& q,
            const Eigen::Ref<const Eigen::VectorXd>& found);
  /// \return the extensions that follow the end of this one: both ways from the start of a try, or
  ///         the next round.
  std::vector<TrackExtension> end(TrackExtension& extension);
  /// Whether no extension is in progress; after end(), that no tries are left.
  bool is_idle() const noexcept { return extensions_left_ == 0; }
  const PathPoses& poses() const noexcept { return poses_; }
  /// Maximum motion of the target in the next step of an extension, joint units.
  double most_motion(const TrackExtension& extension) const;
  int steps() const noexcept { return parameters_.shape_steps; }  ///< of the pull at a pose
  int start_steps() const noexcept;                               ///< at the start of a try

 private:
  /// Start of a try, and its progress to both ends.
  struct Try {
    Eigen::Index start = 0;            // pose
    Eigen::Index first = 0, last = 0;  // poses
    Eigen::MatrixXd along;             // dof x poses; columns first to last. Empty: no start
  };
  /// Configurations from which a track may start at a pose.
  struct Candidates {
    Eigen::MatrixXd configurations;  // dof x n, n >= 0
    Eigen::VectorXd distances_m;     // n: of their shapes from the source's
  };

  Try make_try();
  /// Applies the filters to the unchecked poses of an extension. \return whether they keep all of
  /// them.
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
  std::vector<std::optional<Candidates>> candidates_;  // of each pose; missing: not computed yet
  std::vector<Try> round_;
  std::size_t extensions_left_ = 0;  // of the round
  int idle_ = 0;                     // tries in a row that brought no track
  std::vector<Track> tracks_;
  std::uint64_t tried_ = 0, came_through_ = 0;
};

}  // namespace kinship::transfer
