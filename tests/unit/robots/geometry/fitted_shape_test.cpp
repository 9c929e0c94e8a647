#include "robots/geometry/fitted_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace kinship::geometry::fitted_shape_test {
namespace {

constexpr std::uint64_t kSeed = 8;

/// How far a point lies outside of a shape at most, m.
double farthest_outside(const FittedShape& fitted, const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd local = fitted.T_points_shape.inverse() * points;
  if (const auto* box = std::get_if<BoxShape>(&fitted.shape))
    return (local.cwiseAbs().colwise() - box->size / 2).maxCoeff();
  const auto& capsule = std::get<CapsuleShape>(fitted.shape);
  double farthest = -1;
  for (const auto& p : local.colwise()) {
    const double z = std::max(std::abs(p.z()) - capsule.length_m / 2, 0.0);
    farthest = std::max(farthest, std::hypot(p.x(), p.y(), z) - capsule.radius_m);
  }
  return farthest;
}

Eigen::Matrix3Xd random_points(int count, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&] { return normal(generator); });
}

Eigen::Isometry3d random_pose(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() =
      Eigen::Quaterniond(normal(generator), normal(generator), normal(generator), normal(generator))
          .normalized()
          .toRotationMatrix();
  T.translation() << normal(generator), normal(generator), normal(generator);
  return T;
}

/// Points on a capsule along z.
Eigen::Matrix3Xd on_capsule(double radius_m, double length_m, std::mt19937_64& generator) {
  Eigen::Matrix3Xd points = random_points(4000, generator);
  for (auto p : points.colwise()) {
    const double end = p.z() > 0 ? length_m / 2 : -length_m / 2;
    p = radius_m * p.normalized().eval() + end * Eigen::Vector3d::UnitZ();
  }
  return points;
}

/// The corners of a box.
Eigen::Matrix3Xd on_box(const Eigen::Vector3d& size) {
  Eigen::Matrix3Xd points(3, 8);
  for (Eigen::Index i = 0; i < 8; ++i)
    points.col(i) << (i & 1 ? size.x() : -size.x()) / 2, (i & 2 ? size.y() : -size.y()) / 2,
        (i & 4 ? size.z() : -size.z()) / 2;
  return points;
}

TEST(FitShape, HoldsEveryPointWhateverTheirNumberAndSpread) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> exponent(-4, 1);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d spread(std::pow(10, exponent(generator)),
                                 std::pow(10, exponent(generator)),
                                 std::pow(10, exponent(generator)));
    Eigen::Matrix3Xd points = random_points(1 + i % 50, generator);
    points = random_pose(generator) * (spread.asDiagonal() * points);
    const FittedShape fitted = fit_shape(points);
    EXPECT_LE(farthest_outside(fitted, points), 0) << i;
    EXPECT_EQ(broken_rule(fitted.shape), std::nullopt) << i;
    EXPECT_TRUE((fitted.T_points_shape.linear().transpose() * fitted.T_points_shape.linear())
                    .isIdentity(1e-9));
    EXPECT_GT(fitted.T_points_shape.linear().determinant(), 0);
  }
}

TEST(FitShape, FindsACapsuleHoweverItStands) {
  std::mt19937_64 generator(kSeed);
  const Eigen::Matrix3Xd points = random_pose(generator) * on_capsule(0.06, 0.3, generator);
  const FittedShape fitted = fit_shape(points);
  const auto* capsule = std::get_if<CapsuleShape>(&fitted.shape);
  ASSERT_NE(capsule, nullptr);
  EXPECT_NEAR(capsule->radius_m, 0.06, 2e-3);
  EXPECT_NEAR(capsule->length_m, 0.3, 6e-3);
}

TEST(FitShape, FindsABoxHoweverItStands) {
  std::mt19937_64 generator(kSeed);
  const Eigen::Vector3d size(0.1, 0.2, 0.4);
  const FittedShape fitted = fit_shape(random_pose(generator) * on_box(size));
  const auto* box = std::get_if<BoxShape>(&fitted.shape);
  ASSERT_NE(box, nullptr);
  EXPECT_NEAR(box->size.prod(), size.prod(), 1e-6);
}

TEST(FitShape, GivesFlatAndPointSizedMeshesAThickness) {
  Eigen::Matrix3Xd square = on_box({0.2, 0.2, 0});
  const FittedShape plate = fit_shape(square);
  ASSERT_TRUE(std::holds_alternative<BoxShape>(plate.shape));
  EXPECT_NEAR(std::get<BoxShape>(plate.shape).size.minCoeff(), kMinFitted_m, 1e-8);
  const FittedShape point = fit_shape(Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(point.T_points_shape.translation().isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_EQ(broken_rule(point.shape), std::nullopt);
}

}  // namespace
}  // namespace kinship::geometry::fitted_shape_test
