#include "client/planning/tree.hpp"

#include <cstddef>

namespace kinship::planning {

Eigen::Index Tree::add(const Eigen::VectorXd& q, Eigen::Index parent) {
  const Eigen::Index index = size();
  if (index == nodes_.rows())
    nodes_.conservativeResize(2 * nodes_.rows(), Eigen::NoChange);
  nodes_.row(index) = q.transpose().array();
  parents_.push_back(parent);
  return index;
}

Eigen::Index Tree::nearest(const Eigen::VectorXd& q) const {
  Eigen::ArrayXd squared = (nodes_.col(0).head(size()) - q[0]).square();
  for (Eigen::Index joint = 1; joint < q.size(); ++joint)
    squared += (nodes_.col(joint).head(size()) - q[joint]).square();
  Eigen::Index index = 0;
  squared.minCoeff(&index);
  return index;
}

Eigen::MatrixXd Tree::branch(Eigen::Index index) const {
  std::vector<Eigen::Index> indices;
  for (Eigen::Index i = index; i >= 0; i = parents_[static_cast<std::size_t>(i)])
    indices.push_back(i);
  Eigen::MatrixXd branch(nodes_.cols(), static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i)
    branch.col(static_cast<Eigen::Index>(i)) = node(indices[i]);
  return branch;
}

}  // namespace kinship::planning
