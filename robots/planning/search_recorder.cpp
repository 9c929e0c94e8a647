#include "robots/planning/search_recorder.hpp"

#include <algorithm>
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

}  // namespace kinship::planning
