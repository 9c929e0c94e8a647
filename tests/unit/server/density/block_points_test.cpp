#include "server/density/block_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace kinship::density::block_points_test {
namespace {

BlockPoints blocks_of(const Eigen::MatrixXd& configurations, const Eigen::VectorXd& offset) {
  return {configurations,
          distinct_points(configurations, Eigen::VectorXd::Ones(configurations.cols())), offset};
}

TEST(BlockPoints, HoldEachPointOnceAndFillTheLastBlockWithoutWeight) {
  const Eigen::MatrixXd configurations = Eigen::MatrixXd::Random(3, 1000);
  const Eigen::Vector3d offset(0.5, -1, 2);
  const BlockPoints points = blocks_of(configurations, offset);
  ASSERT_EQ(points.size(), 1000);
  ASSERT_EQ(points.blocks(), 8);
  std::vector<double> expected(configurations.row(0).begin(), configurations.row(0).end());
  std::vector<double> held;
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    const Eigen::VectorXd point = points.point(i) + offset;
    held.push_back(point[0]);
    EXPECT_LT((configurations.colwise() - point).colwise().norm().minCoeff(), 1e-15);
    EXPECT_EQ(points.weight(i), 1);
  }
  std::sort(expected.begin(), expected.end());
  std::sort(held.begin(), held.end());
  for (std::size_t i = 0; i < held.size(); ++i)
    EXPECT_NEAR(held[i], expected[i], 1e-15);
  for (Eigen::Index i = 1000; i < 1024; ++i)
    EXPECT_EQ(points.weight(i), 0);
  EXPECT_EQ(points.total_weight(), 1000);
}

TEST(BlockPoints, BoxesHoldTheirPointsAndAreSmall) {
  const Eigen::MatrixXd configurations = Eigen::MatrixXd::Random(2, 128 * 64);
  const BlockPoints points = blocks_of(configurations, Eigen::Vector2d::Zero());
  double area = 0;
  for (int block = 0; block < points.blocks(); ++block) {
    const Eigen::Map<const Eigen::Vector2d> centre(points.centre(block));
    const Eigen::Map<const Eigen::Vector2d> half(points.half_widths(block));
    for (Eigen::Index i = 0; i < kBlockPoints; ++i) {
      const Eigen::Vector2d point = points.point(block * kBlockPoints + i);
      EXPECT_TRUE(((point - centre).cwiseAbs().array() <= half.array() + 1e-15).all());
    }
    area += 4 * half[0] * half[1];
  }
  EXPECT_LT(area,
            4.1);  // they share the square out; in order of arrival they would have 64 times it
}

TEST(BlockPoints, ThinnedKeepsSpaceAndMeanWeight) {
  const Eigen::MatrixXd configurations = Eigen::MatrixXd::Random(2, 5000);
  const Eigen::VectorXd weights = (1.5 + Eigen::VectorXd::Random(5000).array()).matrix();
  const BlockPoints points(configurations, distinct_points(configurations, weights),
                           Eigen::Vector2d(0.1, 0.2));
  const BlockPoints sample = thinned(points, 1000);
  EXPECT_EQ(sample.size(), 1000);
  EXPECT_EQ(sample.offset(), points.offset());
  EXPECT_NEAR(sample.total_weight(), 1000, 1e-9);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < sample.size(); ++i)
    mean += sample.weight(i) * (sample.point(i) + sample.offset()) / 1000;
  EXPECT_LT((mean - mean_of(configurations, distinct_points(configurations, weights))).norm(),
            0.03);
  EXPECT_EQ(thinned(points, 5000).size(), 5000);
}

}  // namespace
}  // namespace kinship::density::block_points_test
