#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "proto/types/recorded_search.hpp"
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

}  // namespace kinship::planning
