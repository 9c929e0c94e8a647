#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "proto/types/recorded_search.hpp"
#include "robots/planning/nearest_nodes.hpp"
#include "robots/planning/planning_budget.hpp"

namespace kinship::planning {

/// Records how the two trees of a search grow (BirrtOptions::recorder). It changes only the time of
/// the search. Used by one thread, for one search at a time.
class SearchRecorder {
 public:
  enum class Side { Start, Goal };

  /// Begins a search and drops the previous one.
  /// \param budget  gives the number of checks; outlives the calls of add().
  void begin(const PlanningBudget& budget);

  /// Adds a node of a tree. \param parent  in the same tree, -1: a root.
  void add(Side side, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Index parent);

  /// Joins the trees at nodes of equal configuration. No path is recorded if one of the nodes came
  /// after kMaxRecordedNodes.
  void join(Eigen::Index start_node, Eigen::Index goal_node);

  /// The record since begin(), without a name.
  RecordedSearch search() const;

 private:
  std::vector<std::int64_t>& nodes_of(Side side) { return of_tree_[side == Side::Start ? 0 : 1]; }

  const PlanningBudget* budget_ = nullptr;
  std::vector<Eigen::VectorXd> nodes_;
  std::array<std::vector<std::int64_t>, 2> of_tree_;  // a tree's nodes among all
  RecordedSearch search_;                             // without its nodes
};

/// Records a path that no search found, as a tree from the start that ends in the goal. Each
/// waypoint is checked once more, so that the record tells a growth.
void record_path(SearchRecorder& recorder, const IsFree& is_free, const Eigen::MatrixXd& waypoints);

/// A tree of configurations grown from one or more roots.
class Tree {
 public:
  explicit Tree(Eigen::Index dof);

  /// \param parent  index of a node, or -1 for a root.
  /// \return        index of the new node.
  Eigen::Index add(const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Index parent);

  /// Index of the node nearest to q (Euclidean, joint units; the first of equals), to single
  /// precision.
  Eigen::Index nearest(const Eigen::Ref<const Eigen::VectorXd>& q) const {
    return nearest_.find(q);
  }
  /// The same if the nearest of the first nodes is known.
  Eigen::Index nearest(const Eigen::Ref<const Eigen::VectorXd>& q, NearestNode& known) const {
    nearest_.update(q, known);
    return known.index;
  }

  /// Records the present nodes and all later ones. \param recorder  borrowed.
  void record(SearchRecorder& recorder, SearchRecorder::Side side);

  Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(parents_.size()); }
  /// Valid until the next node is added.
  Eigen::MatrixXd::ConstColXpr node(Eigen::Index index) const { return nodes_.col(index); }

  /// \return -1 of a root.
  Eigen::Index parent(Eigen::Index index) const {
    return parents_[static_cast<std::size_t>(index)];
  }

  /// From a node to its root: dof x n.
  Eigen::MatrixXd branch(Eigen::Index index) const;

 private:
  static constexpr Eigen::Index kFirstCapacity = 128;

  Eigen::MatrixXd nodes_;  // dof x capacity
  NearestNodes nearest_;
  std::vector<Eigen::Index> parents_;
  SearchRecorder* recorder_ = nullptr;
  SearchRecorder::Side side_ = SearchRecorder::Side::Start;
};

/// The trees of a search: one from the start, one with every free goal as a root.
class TreePair {
 public:
  explicit TreePair(Eigen::Index dof) : start(dof), goal(dof) {}

  /// Records both trees, present nodes too. \param recorder  borrowed; null: records nothing.
  void record(SearchRecorder* recorder, const PlanningBudget& budget);

  /// Adds the roots. \return why no search is possible; None if it is.
  NoPath plant(const Eigen::VectorXd& from, const Eigen::MatrixXd& goals, PlanningBudget& budget);

  /// The path over two nodes that hold the same configuration.
  Eigen::MatrixXd join(Eigen::Index start_node, Eigen::Index goal_node) const;

  Tree start, goal;

 private:
  SearchRecorder* recorder_ = nullptr;
};

}  // namespace kinship::planning
