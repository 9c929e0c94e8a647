#include "robots/planning/path_vertices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::planning::path_vertices_test {
namespace {

constexpr std::uint64_t kSeed = 3;
constexpr double kStep = 0.1;

double longest_segment(const Eigen::MatrixXd& waypoints) {
  double longest = 0;
  for (Eigen::Index i = 1; i < waypoints.cols(); ++i)
    longest = std::max(longest, (waypoints.col(i) - waypoints.col(i - 1)).norm());
  return longest;
}

Eigen::MatrixXd random_path(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(5, 8, [&] { return normal(generator); });
}

TEST(Densified, CutsSegmentsIntoTheFewestEqualParts) {
  const Eigen::MatrixXd path = (Eigen::MatrixXd(1, 3) << 0, 0.25, 0.35).finished();
  const Eigen::MatrixXd dense = densified(path, kStep);
  ASSERT_EQ(dense.cols(), 5);
  EXPECT_TRUE(
      dense.isApprox((Eigen::MatrixXd(1, 5) << 0, 0.25 / 3, 0.5 / 3, 0.25, 0.35).finished()));
}

TEST(Densified, KeepsVerticesAndLengthAndBoundsTheStep) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd path = random_path(generator);
    const Eigen::MatrixXd dense = densified(path, kStep);
    EXPECT_LE(longest_segment(dense), kStep + 1e-9);
    EXPECT_NEAR(path_length(dense), path_length(path), 1e-9);
    EXPECT_EQ(dense.leftCols(1), path.leftCols(1));
    EXPECT_EQ(dense.rightCols(1), path.rightCols(1));
  }
}

TEST(SparseVertices, UndoDensified) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd path = random_path(generator);
    const Eigen::MatrixXd vertices = sparse_vertices(densified(path, kStep), kStep);
    ASSERT_EQ(vertices.cols(), path.cols());
    EXPECT_TRUE(vertices.isApprox(path, 1e-9));
  }
}

TEST(SparseVertices, KeepWhatDensifiedWouldNotVisitAgain) {
  // Straight, but uneven as a blocked extension followed by another leaves it: were the middle
  // dropped, a check would visit other configurations than those that were found free.
  const Eigen::MatrixXd path = (Eigen::MatrixXd(1, 4) << 0, 0.06, 0.12, 0.22).finished();
  const Eigen::MatrixXd vertices = sparse_vertices(path, kStep);
  EXPECT_TRUE(densified(vertices, kStep).isApprox(path, 1e-9));
  EXPECT_EQ(vertices.cols(), 3);
}

TEST(SparseVertices, DropRepetitionsButKeepTwoEnds) {
  const Eigen::MatrixXd still = Eigen::MatrixXd::Constant(2, 4, 0.5);
  EXPECT_EQ(sparse_vertices(still, kStep).cols(), 2);
  const Eigen::MatrixXd path = (Eigen::MatrixXd(1, 4) << 0, 0.1, 0.1, 0.2).finished();
  EXPECT_EQ(sparse_vertices(path, kStep), (Eigen::MatrixXd(1, 2) << 0, 0.2).finished());
}

TEST(PathLengths, OfJointsAndOfTheHandAreTheirOwn) {
  Eigen::MatrixXd path(3, 3);
  path << 0, M_PI / 2, M_PI / 2, 0, 0, 1, 0, 0, 0;
  const kinematics::Chain arm = collision::test_support::toy_chain(3);  // 0.5 m between joints
  EXPECT_NEAR(path_length(path), M_PI / 2 + 1, 1e-12);
  EXPECT_NEAR(hand_length_m(arm, path), M_PI / 2 + 0.5, 1e-3);
  EXPECT_EQ(hand_length_m(arm, path.leftCols(1)), 0);
}

TEST(PathVertices, RefuseNoWaypointAndNoStep) {
  EXPECT_THROW(densified(Eigen::MatrixXd(2, 0), kStep), std::invalid_argument);
  EXPECT_THROW(sparse_vertices(Eigen::MatrixXd::Zero(2, 2), 0), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::planning::path_vertices_test
