#include "robots/planning/tree.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <limits>
#include <utility>

namespace kinship::planning {

void SearchRecorder::begin(const PlanningBudget& budget) {
  *this = SearchRecorder();
  budget_ = &budget;
}

void SearchRecorder::add(Side side, const Eigen::Ref<const Eigen::VectorXd>& q,
                         Eigen::Index parent) {
  if (nodes_.size() >= kMaxRecordedNodes)
    return;
  std::vector<std::int64_t>& tree = nodes_of(side);
  tree.push_back(static_cast<std::int64_t>(nodes_.size()));
  nodes_.emplace_back(q);
  search_.parents.push_back(parent < 0 ? -1 : tree.at(static_cast<std::size_t>(parent)));
  search_.checks.push_back(budget_->checks());
}

void SearchRecorder::join(Eigen::Index start_node, Eigen::Index goal_node) {
  const auto branch = [&](Side side, Eigen::Index node) {
    std::vector<std::int64_t> nodes;
    const std::vector<std::int64_t>& tree = nodes_of(side);
    if (static_cast<std::size_t>(node) < tree.size())
      for (std::int64_t i = tree[static_cast<std::size_t>(node)]; i >= 0;
           i = search_.parents[static_cast<std::size_t>(i)])
        nodes.push_back(i);
    return nodes;
  };
  std::vector<std::int64_t> path = branch(Side::Start, start_node);
  const std::vector<std::int64_t> rest = branch(Side::Goal, goal_node);
  if (path.empty() || rest.empty())
    return;  // half a path would look like a whole one
  std::ranges::reverse(path);
  path.insert(path.end(), rest.begin(), rest.end());
  search_.path = std::move(path);
}

RecordedSearch SearchRecorder::search() const {
  RecordedSearch search = search_;
  search.nodes.resize(nodes_.empty() ? 0 : nodes_.front().size(),
                      static_cast<Eigen::Index>(nodes_.size()));
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    search.nodes.col(static_cast<Eigen::Index>(i)) = nodes_[i];
  return search;
}

void record_path(SearchRecorder& recorder, const IsFree& is_free,
                 const Eigen::MatrixXd& waypoints) {
  PlanningBudget budget(is_free, std::numeric_limits<std::uint64_t>::max(), std::chrono::hours(1));
  recorder.begin(budget);
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i) {
    budget.is_free(waypoints.col(i));
    recorder.add(SearchRecorder::Side::Start, waypoints.col(i), i - 1);
  }
  recorder.add(SearchRecorder::Side::Goal, waypoints.rightCols<1>(), -1);
  recorder.join(waypoints.cols() - 1, 0);
}

Tree::Tree(Eigen::Index dof) : nodes_(dof, kFirstCapacity), nearest_(dof) {
  parents_.reserve(kFirstCapacity);
}

Eigen::Index Tree::add(const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Index parent) {
  const Eigen::Index index = size();
  if (index == nodes_.cols())
    nodes_.conservativeResize(Eigen::NoChange, 2 * index);
  nodes_.col(index) = q;
  nearest_.add(q);
  parents_.push_back(parent);
  if (recorder_ != nullptr)
    recorder_->add(side_, q, parent);
  return index;
}

void Tree::record(SearchRecorder& recorder, SearchRecorder::Side side) {
  recorder_ = &recorder;
  side_ = side;
  for (Eigen::Index i = 0; i < size(); ++i)
    recorder.add(side, node(i), parents_[static_cast<std::size_t>(i)]);
}

Eigen::MatrixXd Tree::branch(Eigen::Index index) const {
  std::vector<Eigen::Index> indices;
  for (Eigen::Index i = index; i >= 0; i = parents_[static_cast<std::size_t>(i)])
    indices.push_back(i);
  Eigen::MatrixXd branch(nodes_.rows(), static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i)
    branch.col(static_cast<Eigen::Index>(i)) = node(indices[i]);
  return branch;
}

void TreePair::record(SearchRecorder* recorder, const PlanningBudget& budget) {
  recorder_ = recorder;
  if (recorder_ == nullptr)
    return;
  recorder_->begin(budget);
  start.record(*recorder_, SearchRecorder::Side::Start);
  goal.record(*recorder_, SearchRecorder::Side::Goal);
}

NoPath TreePair::plant(const Eigen::VectorXd& from, const Eigen::MatrixXd& goals,
                       PlanningBudget& budget) {
  if (goals.cols() == 0)
    return NoPath::NoGoal;
  if (!budget.is_free(from))
    return budget.exhausted() ? budget.reason() : NoPath::StartCollides;
  start.add(from, -1);
  for (Eigen::Index first = 0; first < goals.cols() && !budget.exhausted();) {
    const Eigen::Index together = std::min(kTogether, goals.cols() - first);
    const Eigen::Index free = budget.free_ahead(goals.middleCols(first, together));
    for (Eigen::Index i = first; i < first + free; ++i)
      goal.add(goals.col(i), -1);
    first += std::min(free + 1, together);
  }
  if (budget.exhausted())
    return budget.reason();
  return goal.size() == 0 ? NoPath::GoalsCollide : NoPath::None;
}

Eigen::MatrixXd TreePair::join(Eigen::Index start_node, Eigen::Index goal_node) const {
  if (recorder_ != nullptr)
    recorder_->join(start_node, goal_node);
  const Eigen::MatrixXd from_start = start.branch(start_node).rowwise().reverse();
  const Eigen::MatrixXd to_goal = goal.branch(goal_node);
  Eigen::MatrixXd path(from_start.rows(), from_start.cols() + to_goal.cols() - 1);
  path << from_start, to_goal.rightCols(to_goal.cols() - 1);
  return path;
}

}  // namespace kinship::planning
