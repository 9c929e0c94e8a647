#include "robots/geometry/mesh_cover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "robots/geometry/fitted_shape.hpp"
#include "tests/support/box_mesh.hpp"

namespace kinship::geometry::mesh_cover_test {
namespace {

constexpr std::uint64_t kSeed = 9;

/// Rounding of a point that lies on a cut.
constexpr double kRounding_m = 1e-9;

/// How far a point lies outside of a shape; not above 0 within it.
double outside(const FittedShape& fitted, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = fitted.T_points_shape.inverse() * point;
  const double across = p.head<2>().norm(), along = std::abs(p.z());
  if (const auto* box = std::get_if<BoxShape>(&fitted.shape))
    return (p.cwiseAbs() - box->size / 2).maxCoeff();
  if (const auto* cylinder = std::get_if<CylinderShape>(&fitted.shape))
    return std::max(across - cylinder->radius_m, along - cylinder->length_m / 2);
  if (const auto* sphere = std::get_if<SphereShape>(&fitted.shape))
    return p.norm() - sphere->radius_m;
  const auto& capsule = std::get<CapsuleShape>(fitted.shape);
  return std::hypot(across, std::max(along - capsule.length_m / 2, 0.0)) - capsule.radius_m;
}

double outside_all(const std::vector<FittedShape>& shapes, const Eigen::Vector3d& point) {
  double least = 1e9;
  for (const FittedShape& shape : shapes)
    least = std::min(least, outside(shape, point));
  return least;
}

Eigen::Isometry3d any_pose(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  const auto next = [&] { return normal(generator); };
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(next(), next(), next(), next()).normalized().toRotationMatrix();
  T.translation() << next(), next(), next();
  return T;
}

Eigen::Matrix3Xd beside(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  Eigen::Matrix3Xd both(3, a.cols() + b.cols());
  both << a, b;
  return both;
}

/// Two legs of a bent link, whose box is mostly empty.
Eigen::Matrix3Xd bent_link() {
  Eigen::Matrix3Xd leg = test::BoxMesh({0.1, 0.1, 0.6}).triangles();
  leg.row(0).array() += 0.5;
  return beside(test::BoxMesh({0.6, 0.1, 0.1}).triangles(), leg);
}

Eigen::Vector3d random_point(const Eigen::Matrix3Xd& corners, std::mt19937_64& generator) {
  std::uniform_int_distribution<Eigen::Index> any(0, corners.cols() / 3 - 1);
  std::uniform_real_distribution<double> unit(0, 1);
  double u = unit(generator), v = unit(generator);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Eigen::Matrix3d triangle = corners.middleCols<3>(3 * any(generator));
  return triangle * Eigen::Vector3d(1 - u - v, u, v);
}

double total_volume_m3(const std::vector<FittedShape>& shapes) {
  double total = 0;
  for (const FittedShape& shape : shapes)
    total += volume_m3(shape.shape);
  return total;
}

bool holds(const std::vector<FittedShape>& solids, const Eigen::Matrix3Xd& corners) {
  std::size_t tests_left = 10'000'000;
  return hold(solids, corners, tests_left);
}

TEST(CoverMesh, HoldsEveryPointOfEveryTriangle) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-3, 0.5);
  for (int i = 0; i < 60; ++i) {
    Eigen::Matrix3Xd corners = i % 3 == 0
                                   ? bent_link()
                                   : Eigen::Matrix3Xd(Eigen::Matrix3Xd::NullaryExpr(
                                         3, 3 * (1 + i % 40), [&] { return normal(generator); }));
    const Eigen::Vector3d spread(std::pow(10, exponent(generator)),
                                 std::pow(10, exponent(generator)),
                                 std::pow(10, exponent(generator)));
    corners = any_pose(generator) * (spread.asDiagonal() * corners);
    const std::vector<FittedShape> shapes = cover_mesh(corners);
    ASSERT_FALSE(shapes.empty());
    EXPECT_LE(std::ssize(shapes), CoverOptions{}.max_shapes);
    for (const FittedShape& shape : shapes)
      EXPECT_EQ(broken_rule(shape.shape), std::nullopt) << i;
    for (const auto& corner : corners.colwise())
      EXPECT_LE(outside_all(shapes, corner), kRounding_m) << i;
    for (int k = 0; k < 500; ++k)
      EXPECT_LE(outside_all(shapes, random_point(corners, generator)), kRounding_m) << i;
  }
}

TEST(CoverMesh, ABentLinkIsCutWhereItBends) {
  const Eigen::Matrix3Xd corners = bent_link();
  const std::vector<FittedShape> whole = cover_mesh(corners, {.max_shapes = 1});
  const std::vector<FittedShape> cut = cover_mesh(corners);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_GT(total_volume_m3(whole), 0.035);
  EXPECT_GE(cut.size(), 2U);
  EXPECT_LT(total_volume_m3(cut), 0.0125) << "the legs have 0.011 m^3";
}

TEST(CoverMesh, ABoxIsOneBoxHoweverItStands) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3Xd corners =
        any_pose(generator) * test::BoxMesh({0.1, 0.25, 0.4}).triangles();
    EXPECT_LT(total_volume_m3(cover_mesh(corners)), 1.02 * 0.01) << i;
  }
}

TEST(CoverMesh, EqualMeshesHaveEqualShapes) {
  const std::vector<FittedShape> once = cover_mesh(bent_link()), again = cover_mesh(bent_link());
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(volume_m3(once[i].shape), volume_m3(again[i].shape));
    EXPECT_EQ(once[i].T_points_shape.matrix(), again[i].T_points_shape.matrix());
  }
}

TEST(CoverMesh, SolidsHoldTheirMeshAndOthersThatMissAPartOfItDoNot) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 10; ++i) {
    const Eigen::Matrix3Xd corners = any_pose(generator) * bent_link();
    std::vector<FittedShape> solids = cover_mesh(corners);
    ASSERT_GE(solids.size(), 2U);
    EXPECT_TRUE(holds(solids, corners)) << i;
    const FittedShape last = solids.back();
    solids.back().T_points_shape.translation().x() += 0.01;
    EXPECT_FALSE(holds(solids, corners)) << i;
    solids.pop_back();
    EXPECT_FALSE(holds(solids, corners)) << i;
    EXPECT_FALSE(holds({}, corners));
    EXPECT_FALSE(holds({last}, corners)) << i;
  }
}

TEST(CoverMesh, AMeshThatSticksOutBetweenItsCornersIsNotHeld) {
  Eigen::Matrix3Xd corners(3, 3);
  corners << -1, 1, 0, 0, 0, 0.01, 0, 0, 0;
  const auto ball_at = [](double x) {
    return FittedShape{SphereShape{0.9}, Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0))};
  };
  EXPECT_TRUE(holds({ball_at(-0.8), ball_at(0.8)}, corners)) << "they overlap";
  EXPECT_FALSE(holds({ball_at(-1), ball_at(1), {SphereShape{0.05}}}, corners))
      << "every corner is in one of them";
}

TEST(FitTightly, IsNeverLargerThanTheFirstGuess) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3Xd points =
        Eigen::Matrix3Xd::NullaryExpr(3, 5 + i, [&] { return normal(generator); });
    const FittedShape tight = fit_tightly(points);
    EXPECT_LE(volume_m3(tight.shape), volume_m3(fit_shape(points).shape) * (1 + 1e-6)) << i;
    for (const auto& point : points.colwise())
      EXPECT_LE(outside(tight, point), kRounding_m) << i;
  }
}

}  // namespace
}  // namespace kinship::geometry::mesh_cover_test
