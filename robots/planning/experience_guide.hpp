#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "proto/types/task_experience.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::planning {

/// Poses of the transfer frame to follow, from the arm's configuration.
struct PoseTrack {
  std::vector<Eigen::Isometry3d> T_base_transfer;  ///< in the base link, n
  Eigen::VectorXd begin;                           ///< dof: puts the transfer frame at the first
  Eigen::VectorXd towards;  ///< dof: attracts the self-motion at the end of the way
};

/// A pose track as followed by an arm.
struct Track {
  Eigen::MatrixXd configurations;  ///< dof x m, 1 <= m <= n: configurations at their poses
  double gap = 0;                  ///< from the last configuration to `towards`, joint units
  bool is_goal_free = false;       ///< its first configuration is a goal, and was found free
};

/// Follows pose tracks with an arm, each configuration from the one before, eight at a time: damped
/// least squares, joints held within their limits, drawn a little towards the straight line from
/// `begin` to `towards` within the task's freedom. Poses missed by more than 4 cm or 0.25 rad are
/// skipped.
/// Source of the step: robots/inverse/lanes.hpp.
std::vector<Track> follow(const inverse::Solver& solver, std::span<const PoseTrack> tracks);

/// Start and goal of a query, as poses of the transfer frame in the task frame.
struct PoseQuery {
  Eigen::Isometry3d T_task_start;
  Eigen::Isometry3d T_task_goal;
};

/// Distance of two poses, m: a radian counts as 0.3 m.
double pose_distance_m(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// The paths nearest to a query, by the sum of the distances of their start and goal poses.
/// \return indices into `paths`, the nearest first, at most `count`.
std::vector<std::size_t> nearest_paths(const std::vector<PosePath>& paths, const PoseQuery& query,
                                       std::size_t count);

/// Between two poses, a at a weight of 0, b at 1, these themselves beyond. Rotations by normalised
/// linear interpolation.
Eigen::Isometry3d blended(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double weight);

/// The path moved onto the query: its start to the query's start, its goal to the query's goal. The
/// first half blends from one motion to the other, the second half is moved with the goal alone, as
/// the way around a goal is mostly narrower than that around a start. Rotations by normalised
/// linear interpolation.
/// \return as many poses as the path has; the first and last are those of the query.
std::vector<Eigen::Isometry3d> moved_onto(const PosePath& path, const PoseQuery& query);

/// A path without experience: the hand moves straight to the pose `distance_m` before its goal,
/// against the z axis of the transfer frame, which points out of the palm, and from there straight
/// to the goal. With 0 it moves straight all the way.
PosePath retreat(double distance_m);

/// Options of a task's experience in one query.
struct TrackOptions {
  std::size_t paths = 20;   ///< of the experience, those nearest to the query
  std::size_t tracks = 40;  ///< at most: each path is followed from several goals
  /// Goals, at most, from which a track without experience (see `retreat`) is tried before the
  /// stored ways, the nearest to the start first.
  std::size_t retreats = 0;
  double retreat_m = 0.4;
  double deviation = 0.3;       ///< of samples from tracks, each joint, joint units
  double check_fraction = 0.3;  ///< see BirrtOptions::track_check_fraction
};

/// One robot's query, as needed for tracks.
struct TrackQuery {
  Eigen::Isometry3d T_task_base;
  Eigen::Matrix2Xd bounds;  ///< 2 x dof: configurations outside are left out (planning_bounds)
  Eigen::VectorXd start;    ///< dof
  Eigen::MatrixXd goals;    ///< dof x n
  /// A stored path not to follow: the solution of this query, if the query is planned again.
  std::optional<Uuid> without = {};
  /// Whole paths that are not free, dof x n each, from the start to a goal that was found free;
  /// what is before a column that is not finite is left out. Asked once, when all tracks before
  /// them have failed, and followed from their goals, too; empty: there are none.
  std::function<std::vector<Eigen::MatrixXd>()> failed_paths = {};
};

/// Tracks for one robot's query from a task's experience: the stored ways of the hand nearest to
/// the query, moved onto it and followed by the robot's arm from the query's own goal
/// configurations. Checks no collisions. Immutable; may be shared between threads.
class ExperienceGuide {
 public:
  /// A way and the goal to follow it from.
  struct Choice {
    Eigen::Index goal;
    std::optional<std::size_t> path;  ///< of the experience; missing: the retreat
  };

  /// \throws std::invalid_argument if a path has less than two poses.
  ExperienceGuide(const kinematics::Chain& chain, TaskExperience experience);

  /// The ways in the order to follow them: for each goal, the nearest to the start first, the
  /// retreat; then for each goal the stored way nearest to the query, then the next, and so on.
  std::vector<Choice> choose(const TrackQuery& query, const TrackOptions& options) const;

  /// \return tracks from a goal towards the start, each within the bounds; the one that ends
  ///         nearest to the start first.
  std::vector<Track> follow(const TrackQuery& query, std::span<const Choice> choices,
                            const TrackOptions& options) const;

  const TaskExperience& experience() const noexcept { return experience_; }

 private:
  std::vector<std::size_t> nearest(const PoseQuery& query, std::size_t count,
                                   const std::optional<Uuid>& without) const;

  kinematics::Chain chain_;
  inverse::Solver solver_;
  TaskExperience experience_;
};

/// The tracks of one query, made a few at a time on demand: a query solved by a straight line makes
/// none. Used by one thread.
class QueryTracks {
 public:
  /// \param guide  not null.
  /// \throws std::invalid_argument if the deviation is negative or not finite.
  QueryTracks(std::shared_ptr<const ExperienceGuide> guide, TrackQuery query,
              const TrackOptions& options);

  /// \return null: there are no more.
  const Track* track(std::size_t index);

  /// A normal sample about a configuration of the tracks made so far, all equally likely, within
  /// the bounds; empty if there is no track, or if no draw of many lay within.
  std::optional<Eigen::VectorXd> sample(std::mt19937_64& generator);

 private:
  void make_some();
  void add(Track track);
  void add_failed_paths();

  const std::shared_ptr<const ExperienceGuide> guide_;
  TrackQuery query_;  // failed_paths: until they are asked
  const TrackOptions options_;
  std::optional<std::vector<ExperienceGuide::Choice>> choices_;  // not made yet
  std::size_t followed_ = 0;                                     // of the choices
  std::vector<Track> tracks_;
  std::vector<Eigen::VectorXd> configurations_;  // of all tracks
};

}  // namespace kinship::planning
