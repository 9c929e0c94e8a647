#include "robots/planning/tree.hpp"

#include <gtest/gtest.h>

namespace kinship::planning::tree_test {
namespace {

TEST(Tree, BranchLeadsFromANodeToItsRoot) {
  Tree tree(1);
  const auto q = [](double value) { return Eigen::VectorXd::Constant(1, value).eval(); };
  tree.add(q(0), -1);
  tree.add(q(10), -1);
  const Eigen::Index child = tree.add(q(11), 1);
  tree.add(q(1), 0);
  const Eigen::Index grandchild = tree.add(q(12), child);
  EXPECT_EQ(tree.branch(grandchild), (Eigen::MatrixXd(1, 3) << 12, 11, 10).finished());
  EXPECT_EQ(tree.branch(0), Eigen::MatrixXd::Zero(1, 1));
}

}  // namespace
}  // namespace kinship::planning::tree_test
