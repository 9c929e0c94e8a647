#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/task_experience.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/moved_path.hpp"
#include "robots/planning/track_lanes.hpp"

namespace kinship::planning {

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

}  // namespace kinship::planning
