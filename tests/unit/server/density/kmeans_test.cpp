#include "server/density/kmeans.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kinship::density::kmeans_test {
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

/// With the origin as offset, so that numbers are those of the columns.
BlockPoints blocks_of(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights) {
  return {points, distinct_points(points, weights), Eigen::VectorXd::Zero(points.rows())};
}
BlockPoints blocks_of(const Eigen::MatrixXd& points) {
  return blocks_of(points, Eigen::VectorXd::Ones(points.cols()));
}

Eigen::MatrixXd columns_of(const BlockPoints& points) {
  Eigen::MatrixXd columns(points.dimension(), points.size());
  for (Eigen::Index i = 0; i < points.size(); ++i)
    columns.col(i) = points.point(i);
  return columns;
}

TEST(ChooseCentres, FindsOneCentreInEachSeparateGroup) {
  const BlockPoints points = blocks_of(three_groups());
  Eigen::MatrixXd middles(2, 3);
  middles << 0, 10, 0,  //
      0, 0, 10;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 generator(seed);
    const Eigen::MatrixXd centres = choose_centres(points, 3, widest_simd_kernels(), generator);
    std::vector<int> groups = nearest_centres(blocks_of(centres), middles, widest_simd_kernels());
    std::sort(groups.begin(), groups.end());
    EXPECT_EQ(groups, (std::vector<int>{0, 1, 2})) << "seed " << seed;
  }
}

TEST(ChooseCentres, AreNoMoreThanTheDistinctPoints) {
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(2, 50);
  points.rightCols(10).setOnes();
  std::mt19937_64 generator(kSeed);
  EXPECT_EQ(choose_centres(blocks_of(points), 5, widest_simd_kernels(), generator).cols(), 2);
}

TEST(ChooseCentres, FollowTheWeights) {
  Eigen::MatrixXd points(1, 3);
  points << 0, 1, 2;
  const BlockPoints weighted = blocks_of(points, Eigen::Vector3d(1e-6, 1, 1e-6));
  int middle_first = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 generator(seed);
    if (choose_centres(weighted, 1, widest_simd_kernels(), generator)(0, 0) == 1)
      ++middle_first;
  }
  EXPECT_EQ(middle_first, 200);
}

TEST(NearestCentres, AgreeWithDistancesWrittenOut) {
  const BlockPoints blocks = blocks_of(5 * Eigen::MatrixXd::Random(3, 700));
  const Eigen::MatrixXd points = columns_of(blocks);
  const Eigen::MatrixXd centres = 5 * Eigen::MatrixXd::Random(3, 13);
  const std::vector<int> nearest = nearest_centres(blocks, centres, widest_simd_kernels());
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
  const Eigen::MatrixXd centres =
      move_centres(blocks_of(points, weights), start, 10, widest_simd_kernels());
  const Eigen::Vector2d heavy = points.leftCols(100) * weights.head(100) / weights.head(100).sum();
  EXPECT_LT((centres.col(0) - heavy).norm(), 1e-12);
  EXPECT_LT((centres.col(1) - points.middleCols(100, 100).rowwise().mean()).norm(), 1e-12);
}

TEST(MoveCentres, CentreWithoutPointsStays) {
  Eigen::MatrixXd start(2, 2);
  start << 0, 1000, 0, 1000;
  const Eigen::MatrixXd centres =
      move_centres(blocks_of(three_groups()), start, 10, widest_simd_kernels());
  EXPECT_EQ(centres.col(1), start.col(1));
}

TEST(ChooseCentres, ABlockThatIsLeftOutWouldNotHaveChanged) {
  // 40 centres among 3000 points: most blocks are left out of most tries. Afterwards each centre
  // must be a point, and no point far from all of them.
  const BlockPoints points = blocks_of(Eigen::MatrixXd::Random(2, 3000));
  std::mt19937_64 generator(kSeed);
  const Eigen::MatrixXd centres = choose_centres(points, 40, widest_simd_kernels(), generator);
  const Eigen::MatrixXd columns = columns_of(points);
  double total = 0;
  for (Eigen::Index i = 0; i < columns.cols(); ++i)
    total += (centres.colwise() - columns.col(i)).colwise().squaredNorm().minCoeff();
  EXPECT_LT(total / 3000, 2 * 4.0 / 40 / 6);  // twice what squares of equal area would have
  for (Eigen::Index k = 0; k < centres.cols(); ++k)
    EXPECT_EQ((columns.colwise() - centres.col(k)).colwise().squaredNorm().minCoeff(), 0);
}

TEST(MomentsOfClusters, AreThoseOfTheirPoints) {
  const BlockPoints points = blocks_of(three_groups());
  std::vector<int> cluster(300, 0);
  for (std::size_t i = 150; i < 300; ++i)
    cluster[i] = 1;
  const Moments moments = moments_of_clusters(points, cluster, 2);
  const Eigen::MatrixXd columns = columns_of(points);
  EXPECT_NEAR(moments.mass(1), 150, 1e-10);
  EXPECT_TRUE(
      moments.sums.col(0).segment(1, 2).isApprox(columns.leftCols(150).rowwise().sum(), 1e-10));
  EXPECT_NEAR(moments.sums(4, 1), columns.rightCols(150).row(0).dot(columns.rightCols(150).row(1)),
              1e-9);
}

}  // namespace
}  // namespace kinship::density::kmeans_test
