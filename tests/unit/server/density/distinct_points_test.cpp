#include "server/density/distinct_points.hpp"

#include <gtest/gtest.h>

#include <limits>

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

}  // namespace
}  // namespace kinship::density::distinct_points_test
