#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "proto/types/recorded_search.hpp"
#include "robots/planning/planning_budget.hpp"

namespace kinship::planning {

/// Writes down how the two trees of a search grow (BirrtOptions::recorder). It changes nothing of
/// the search but its time. Of one thread, and of one search at a time.
class SearchRecorder {
 public:
  enum class Side { Start, Goal };

  /// A search begins, and forgets the one before. \param budget  of which checks are told; as long
  /// as nodes come.
  void begin(const PlanningBudget& budget);

  /// A tree has a new node. \param parent  in the same tree, -1: a root.
  void add(Side side, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Index parent);

  /// Both trees have met in nodes that hold the same configuration. There is no path if one
  /// of them came after kMaxRecordedNodes.
  void join(Eigen::Index start_node, Eigen::Index goal_node);

  /// What was recorded since begin(); without a name.
  RecordedSearch search() const;

 private:
  std::vector<std::int64_t>& nodes_of(Side side) { return of_tree_[side == Side::Start ? 0 : 1]; }

  const PlanningBudget* budget_ = nullptr;
  std::vector<Eigen::VectorXd> nodes_;
  std::array<std::vector<std::int64_t>, 2> of_tree_;  // a tree's nodes among all
  RecordedSearch search_;                             // without its nodes
};

}  // namespace kinship::planning
