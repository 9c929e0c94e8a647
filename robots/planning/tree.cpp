#include "robots/planning/tree.hpp"

#include <cstddef>

namespace kinship::planning {

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

}  // namespace kinship::planning
