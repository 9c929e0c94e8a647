#include "server/density/distinct_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "server/density/block_points.hpp"

namespace kinship::density::distinct_points_test {
namespace {

Eigen::MatrixXd columns_of(const Eigen::MatrixXd& configurations, const DistinctPoints& points) {
  Eigen::MatrixXd chosen(configurations.rows(), static_cast<Eigen::Index>(points.columns.size()));
  for (std::size_t i = 0; i < points.columns.size(); ++i)
    chosen.col(static_cast<Eigen::Index>(i)) = configurations.col(points.columns[i]);
  return chosen;
}

TEST(DistinctPoints, EqualConfigurationsAddTheirWeights) {
  Eigen::MatrixXd configurations(2, 4);
  configurations << 3, 1, 3, 1,  //
      0, 5, 0, 4;
  const DistinctPoints points = distinct_points(configurations, Eigen::Vector4d(1, 2, 3, 3));
  Eigen::MatrixXd expected(2, 3);
  expected << 1, 1, 3,  //
      4, 5, 0;
  EXPECT_EQ(columns_of(configurations, points), expected);
  ASSERT_EQ(points.weights.size(), 3U);
  EXPECT_NEAR(points.weights[0], 3.0 / 3, 1e-14);
  EXPECT_NEAR(points.weights[1], 2.0 / 3, 1e-14);
  EXPECT_NEAR(points.weights[2], 4.0 / 3, 1e-14);
}

TEST(DistinctPoints, WithoutWeightOrUnwantedAreLeftOut) {
  Eigen::MatrixXd configurations(1, 4);
  configurations << 1, 2, 3, 4;
  const DistinctPoints points =
      distinct_points(configurations, Eigen::Vector4d(1, 0, 1, 1), {1, 1, 1, 0});
  EXPECT_EQ(points.columns, (std::vector<std::uint32_t>{0, 2}));
}

TEST(DistinctPoints, WeightsAreNumbersHoweverSmallOrFarApart) {
  Eigen::MatrixXd configurations(1, 4);
  configurations << 1, 2, 3, 3;
  constexpr double kMin = std::numeric_limits<double>::denorm_min();
  const DistinctPoints light =
      distinct_points(configurations, Eigen::Vector4d(kMin, 2 * kMin, kMin, 2 * kMin));
  EXPECT_EQ(light.weights, (std::vector<double>{3.0 / 6, 6.0 / 6, 9.0 / 6}));
  const DistinctPoints apart =
      distinct_points(configurations, Eigen::Vector4d(kMin, 1, 1e308, 0.5e308));
  EXPECT_GT(apart.weights[0], 0);
  EXPECT_LT(apart.weights[1], 1e-99);
  EXPECT_NEAR(apart.weights[2], 3, 1e-12);
}

TEST(DistinctPoints, OrderChangesNoBit) {
  const Eigen::MatrixXd configurations = Eigen::MatrixXd::Random(3, 10).replicate(1, 4);
  const Eigen::VectorXd weights = (1.5 + Eigen::VectorXd::Random(40).array()).matrix();
  const DistinctPoints forward = distinct_points(configurations, weights);
  const Eigen::MatrixXd reversed = configurations.rowwise().reverse();
  const DistinctPoints backward = distinct_points(reversed, weights.reverse());
  EXPECT_EQ(columns_of(configurations, forward), columns_of(reversed, backward));
  EXPECT_EQ(forward.weights, backward.weights);
}

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
}  // namespace kinship::density::distinct_points_test
