#pragma once

#include <Eigen/Core>
#include <vector>

#include "robots/planning/nearest_nodes.hpp"
#include "robots/planning/search_recorder.hpp"

namespace kinship::planning {

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

}  // namespace kinship::planning
