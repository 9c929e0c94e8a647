#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/recall_library.hpp"
#include "proto/types/scene.hpp"
#include "proto/types/uuid.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/recall/warp.hpp"

namespace kinship::recall {

/// A query, as needed to recall paths.
struct Query {
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  Eigen::Matrix2Xd bounds;  ///< 2 x dof (planning_bounds)
  Eigen::VectorXd start;    ///< dof
  Eigen::MatrixXd goals;    ///< dof x n; n = 0: any configuration at the pose
  Eigen::Isometry3d T_base_goal = Eigen::Isometry3d::Identity();  ///< if there are no goals
  /// Of RecallLibrary::anchors in this scene; nothing: it is not there.
  std::vector<std::optional<Eigen::Isometry3d>> T_task_anchors = {};
  /// That the whole path keeps, with these bounds; null: none. Counts the projections.
  planning::RegionConstraint* constraint = nullptr;
  /// A recorded query whose own solution is left out, as it is planned again.
  std::optional<Uuid> without = {};
};

/// Where the objects of these names are in a scene.
std::vector<std::optional<Eigen::Isometry3d>> find_anchors(const std::vector<std::string>& anchors,
                                                           const std::vector<SceneObject>& objects);

/// A path in one mode, for one goal.
struct Candidate {
  std::size_t path = 0, mode = 0;
  Eigen::Index goal = -1;  ///< of the query's; -1: at the pose, with the posture of the path
  double distance = 0;     ///< of the query that it solved
};

/// A library as its robot recalls from it. Immutable; may be shared between threads.
class RecallGuide {
 public:
  /// \param library  keeps validate(), for this chain.
  /// \throws std::invalid_argument if its waypoints have another number of joints.
  RecallGuide(const kinematics::Chain& chain, RecallLibrary library);

  const RecallLibrary& library() const noexcept { return library_; }
  const Warper& warper() const noexcept { return warper_; }

  /// A path to be moved onto a query; borrows this.
  /// \return nothing if the frame of its mode is not in the scene, or no configuration near the
  ///         path's end reaches the goal's pose.
  std::optional<Warp> warp(const Query& query, const Candidate& candidate) const;

  /// Length of a path, joint units.
  double length(std::size_t path) const { return lengths_[path]; }

  /// What distances of queries are measured by: a query's goals are configurations, or a pose.
  enum class Metric { Configurations, Poses };

  /// The paths of other reports nearest to a query of the library, at most `count`, in no order.
  std::vector<std::size_t> nearest_paths(Metric metric, std::size_t query, std::size_t count) const;

  /// Whether a path answers a query of the library: it judges nothing there.
  bool answers(std::size_t path, std::size_t query) const {
    return library_.queries[library_.paths[path].query].report == library_.queries[query].report;
  }

 private:
  friend class Ranking;

  /// Start and goal, as distances see them.
  struct Ends {
    Eigen::VectorXd start, goal;      // dof
    Eigen::Isometry3d T_facing_goal;  // in the base link turned towards it about z
    double azimuth = 0;               // by which it is turned, rad
    Eigen::Isometry3d T_frame_goal;   // in the frame of frame_
  };

  /// What the library tells by one metric.
  struct Learned {
    std::vector<std::uint8_t> works;          // modes x queries of path after path: 0 or 1
    std::vector<double> edges;                // of bins of distances, ascending
    std::vector<std::vector<double>> worked;  // modes x bins: chance, 0 to 1
    double near = 1;                          // a usual distance of neighbours
  };

  Eigen::Isometry3d T_base_frame(
      const Eigen::Isometry3d& T_task_base,
      const std::vector<std::optional<Eigen::Isometry3d>>& T_task_anchors) const;
  Ends ends_of(const Eigen::VectorXd& start, const Eigen::Isometry3d& T_base_goal,
               const Eigen::VectorXd& goal, const Eigen::Isometry3d& T_base_frame) const;
  /// Distance of the starts, and of the goals, joint units or the like.
  struct Distances {
    double start = 0, goal = 0;
    double together(double least_start = 0) const { return std::hypot(start - least_start, goal); }
  };
  Distances distances(Metric metric, const Ends& a, const Ends& b) const;
  void learn(Metric metric);
  double chance_at(Metric metric, std::size_t mode, double distance) const;
  /// Of each query, whether a path in a mode solves it.
  const std::uint8_t* works(Metric metric, std::size_t path, std::size_t mode) const {
    return &learned_.at(static_cast<std::size_t>(metric))
                .works[(path * library_.modes.size() + mode) * library_.queries.size()];
  }
  bool is_usable(const Query& query, std::size_t mode) const;
  std::optional<Eigen::VectorXd> goal_at_pose(const Query& query, std::size_t path) const;

  Warper warper_;
  RecallLibrary library_;
  inverse::Descent descent_;
  std::uint32_t frame_ = kTaskFrame;  // that distances are measured in, besides the base
  std::vector<WarpedPath> paths_;
  std::vector<double> lengths_;     // of paths, joint units
  std::vector<Ends> path_ends_;     // of paths
  std::vector<Ends> ends_;          // of queries
  std::array<Learned, 2> learned_;  // by metric
};

/// Candidates for one query, the most promising next. Used by one thread.
/// Source: the chance of a candidate is that of its distance, corrected by how it did on the
/// recorded queries nearest to this one (a kernel estimate).
class Ranking {
 public:
  /// \param trust  factor of every chance, 0 to 1: what the experience of this client says.
  Ranking(const RecallGuide& guide, const Query& query, double trust);

  /// The next one to try; nothing: no other one is worth its checks.
  /// \param step  between checked configurations, joint units.
  std::optional<Candidate> next(double step);

  /// The candidate of next() did not work, though its goal is free.
  void fail();

  /// The candidate of next() has no free goal. Other modes of its path have the same one, and paths
  /// that end in a posture like it one that is near.
  void fail_at_goal();

  /// Of the candidate of next(): its chance to work, 0 to 1.
  double chance() const noexcept { return last_chance_; }

 private:
  struct Ranked {
    Candidate candidate;
    double chance = 0;
    double goal_is_free = 1;  // factor of the chance
    bool is_tried = false;
  };
  /// The candidates for one goal.
  struct Group {
    double trust = 1;                                   // of its chances
    std::vector<std::pair<std::size_t, double>> alike;  // recorded queries, and how much
    std::vector<Ranked> ranked;
  };

  void add_goal(const Query& query, Eigen::Index goal);
  void rank(Group& group) const;

  const RecallGuide& guide_;
  const double trust_;
  const RecallGuide::Metric metric_;
  std::vector<Group> groups_;
  Ranked* last_ = nullptr;  // that next() gave
  Group* of_last_ = nullptr;
  double last_chance_ = 0;
  double doubt_ = 1;  // factor of every chance
};

}  // namespace kinship::recall
