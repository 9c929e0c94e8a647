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

/// How the experience of a task is used in one query.
struct TrackOptions {
  std::size_t paths = 20;   ///< of the experience, the most like the query
  std::size_t tracks = 40;  ///< at most: each path is followed from several goals
  /// Before the stored ways one is tried that needs no experience (see `retreat`), from so many
  /// goals at most, the nearest to the start first.
  std::size_t retreats = 0;
  double retreat_m = 0.4;
  double deviation = 0.3;       ///< of samples from tracks, each joint, joint units
  double check_fraction = 0.3;  ///< see BirrtOptions::track_check_fraction
};

/// A query of one robot as tracks need it.
struct TrackQuery {
  Eigen::Isometry3d T_task_base;
  Eigen::Matrix2Xd bounds;  ///< 2 x dof: configurations outside are left out (planning_bounds)
  Eigen::VectorXd start;    ///< dof
  Eigen::MatrixXd goals;    ///< dof x n
  /// A stored path that is not followed: the one that answered this query, if it is planned again.
  std::optional<Uuid> without = {};
};

/// What a task's experience says about a query of one robot: the stored ways of the hand that are
/// most like it, moved onto it and followed by the robot's arm from the query's own goal
/// configurations. Asks no collision question. Immutable; may be shared between threads.
class ExperienceGuide {
 public:
  /// One way, to be followed from one goal.
  struct Choice {
    Eigen::Index goal;
    std::optional<std::size_t> path;  ///< of the experience; missing: the retreat
  };

  /// \throws std::invalid_argument if a path has less than two poses.
  ExperienceGuide(const kinematics::Chain& chain, TaskExperience experience);

  /// What to follow in which order: for each goal, the nearest to the start first, the retreat;
  /// then for each goal the stored way most like the query, then the next, and so on.
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
