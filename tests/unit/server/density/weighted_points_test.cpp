#include "server/density/weighted_points.hpp"

#include <gtest/gtest.h>

namespace kinship::density {
namespace {

TEST(PreparePoints, EqualConfigurationsAddTheirWeights) {
  Eigen::MatrixXd configurations(2, 4);
  configurations << 3, 1, 3, 1,  //
      0, 5, 0, 4;
  const WeightedPoints points = prepare_points(configurations, Eigen::Vector4d(1, 2, 3, 3));
  ASSERT_EQ(points.points.cols(), 3);
  Eigen::MatrixXd expected(2, 3);
  expected << 1, 1, 3,  //
      4, 5, 0;
  EXPECT_TRUE((points.points.colwise() + points.offset).isApprox(expected, 1e-14));
  EXPECT_TRUE(points.weights.isApprox(Eigen::Vector3d(3, 2, 4) / 3, 1e-14));
}

TEST(PreparePoints, ConfigurationWithoutWeightIsLeftOut) {
  Eigen::MatrixXd configurations(1, 3);
  configurations << 1, 2, 3;
  EXPECT_EQ(prepare_points(configurations, Eigen::Vector3d(1, 0, 1)).points.cols(), 2);
}

TEST(PreparePoints, WeightedMeanIsTheOrigin) {
  const Eigen::MatrixXd configurations = (5 + Eigen::MatrixXd::Random(3, 40).array()).matrix();
  const Eigen::VectorXd weights = (1.5 + Eigen::VectorXd::Random(40).array()).matrix();
  const WeightedPoints points = prepare_points(configurations, weights);
  EXPECT_LT((points.points * points.weights).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(points.weights.sum(), 40, 1e-12);
}

TEST(PreparePoints, OrderChangesNoBit) {
  const Eigen::MatrixXd configurations = Eigen::MatrixXd::Random(3, 10).replicate(1, 4);
  const Eigen::VectorXd weights = (1.5 + Eigen::VectorXd::Random(40).array()).matrix();
  const WeightedPoints forward = prepare_points(configurations, weights);
  const WeightedPoints backward =
      prepare_points(configurations.rowwise().reverse(), weights.reverse());
  EXPECT_EQ(forward.points, backward.points);
  EXPECT_EQ(forward.weights, backward.weights);
}

}  // namespace
}  // namespace kinship::density
