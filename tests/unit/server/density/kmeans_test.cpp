#include "server/density/kmeans.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kinship::density {
namespace {

constexpr std::uint64_t kSeed = 5;

/// Three groups of 100 points around (0, 0), (10, 0) and (0, 10).
Eigen::MatrixXd three_groups() {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal(0, 0.3);
  Eigen::MatrixXd points = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return normal(generator); });
  points.row(0).segment(100, 100).array() += 10;
  points.row(1).tail(100).array() += 10;
  return points;
}

TEST(ChooseCentres, FindsOneCentreInEachSeparateGroup) {
  const Eigen::MatrixXd points = three_groups();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 generator(seed);
    const Eigen::MatrixXd centres =
        choose_centres(points, Eigen::VectorXd::Ones(300), 3, generator);
    std::vector<Eigen::Index> groups;
    for (const Eigen::Index k : nearest_centres(centres, (Eigen::MatrixXd(2, 3) << 0, 10, 0,  //
                                                          0, 0, 10)
                                                             .finished()))
      groups.push_back(k);
    std::sort(groups.begin(), groups.end());
    EXPECT_EQ(groups, (std::vector<Eigen::Index>{0, 1, 2})) << "seed " << seed;
  }
}

TEST(ChooseCentres, AreNoMoreThanTheDistinctPoints) {
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(2, 50);
  points.rightCols(10).setOnes();
  std::mt19937_64 generator(kSeed);
  EXPECT_EQ(choose_centres(points, Eigen::VectorXd::Ones(50), 5, generator).cols(), 2);
}

TEST(ChooseCentres, FollowTheWeights) {
  Eigen::MatrixXd points(1, 3);
  points << 0, 1, 2;
  int middle_first = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 generator(seed);
    if (choose_centres(points, Eigen::Vector3d(1e-6, 1, 1e-6), 1, generator)(0, 0) == 1)
      ++middle_first;
  }
  EXPECT_EQ(middle_first, 200);
}

TEST(NearestCentres, AgreeWithDistancesWrittenOut) {
  const Eigen::MatrixXd points = 5 * Eigen::MatrixXd::Random(3, 700);
  const Eigen::MatrixXd centres = 5 * Eigen::MatrixXd::Random(3, 13);
  const std::vector<Eigen::Index> nearest = nearest_centres(points, centres);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::Index expected = 0;
    (centres.colwise() - points.col(i)).colwise().squaredNorm().minCoeff(&expected);
    EXPECT_EQ(nearest[static_cast<std::size_t>(i)], expected);
  }
}

TEST(MoveCentres, EndInTheWeightedMeansOfTheirPoints) {
  const Eigen::MatrixXd points = three_groups();
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(300);
  weights[0] = 50;
  Eigen::MatrixXd start(2, 3);
  start << 1, 8, 1, 1, 1, 8;
  const Eigen::MatrixXd centres = move_centres(points, weights, start, 10);
  const Eigen::Vector2d heavy = points.leftCols(100) * weights.head(100) / weights.head(100).sum();
  EXPECT_LT((centres.col(0) - heavy).norm(), 1e-12);
  EXPECT_LT((centres.col(1) - points.middleCols(100, 100).rowwise().mean()).norm(), 1e-12);
}

TEST(MoveCentres, CentreWithoutPointsStays) {
  Eigen::MatrixXd start(2, 2);
  start << 0, 1000, 0, 1000;
  const Eigen::MatrixXd centres =
      move_centres(three_groups(), Eigen::VectorXd::Ones(300), start, 10);
  EXPECT_EQ(centres.col(1), start.col(1));
}

}  // namespace
}  // namespace kinship::density
