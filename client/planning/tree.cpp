#include "client/planning/tree.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace kinship::planning {

Tree::Tree(Eigen::Index dof) : nodes_(dof, kFirstCapacity), scanned_(kFirstCapacity, dof) {
  parents_.reserve(kFirstCapacity);
}

Eigen::Index Tree::add(const Eigen::VectorXd& q, Eigen::Index parent) {
  const Eigen::Index index = size();
  if (index == nodes_.cols()) {
    nodes_.conservativeResize(Eigen::NoChange, 2 * index);
    scanned_.conservativeResize(2 * index, Eigen::NoChange);
  }
  nodes_.col(index) = q;
  scanned_.row(index) = q.cast<float>().transpose().array();
  parents_.push_back(parent);
  return index;
}

Eigen::Index Tree::nearest(const Eigen::VectorXd& q) const {
  constexpr Eigen::Index kBlock = 256;  // stays in the first-level cache, on the stack
  using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
  Eigen::Index nearest = 0;
  float least = std::numeric_limits<float>::infinity();
  for (Eigen::Index first = 0; first < size(); first += kBlock) {
    const Eigen::Index count = std::min(kBlock, size() - first);
    Block squared = (scanned_.col(0).segment(first, count) - static_cast<float>(q[0])).square();
    for (Eigen::Index joint = 1; joint < q.size(); ++joint)
      squared +=
          (scanned_.col(joint).segment(first, count) - static_cast<float>(q[joint])).square();
    if (squared.minCoeff() >= least)
      continue;
    Eigen::Index within = 0;
    least = squared.minCoeff(&within);
    nearest = first + within;
  }
  return nearest;
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
