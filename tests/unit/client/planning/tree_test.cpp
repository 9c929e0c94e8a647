#include "client/planning/tree.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinship::planning::tree_test {
namespace {

constexpr std::uint64_t kSeed = 5;

TEST(Tree, NearestIsTheNearestOfAll) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> joint(-3, 3);
  const auto random = [&] {
    return Eigen::VectorXd::NullaryExpr(7, [&] { return joint(generator); }).eval();
  };
  Tree tree(7);
  std::vector<Eigen::VectorXd> nodes;
  for (int i = 0; i < 3000; ++i) {  // more than the first capacity
    nodes.emplace_back(random());
    EXPECT_EQ(tree.add(nodes.back(), i - 1), i);
  }
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd q = random();
    const auto nearest = std::min_element(nodes.begin(), nodes.end(),
                                          [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
                                            return (a - q).squaredNorm() < (b - q).squaredNorm();
                                          });
    EXPECT_EQ(tree.nearest(q), nearest - nodes.begin());
    EXPECT_EQ(tree.node(tree.nearest(q)), *nearest);
  }
}

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
