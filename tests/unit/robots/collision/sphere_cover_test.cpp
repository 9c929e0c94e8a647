#include "robots/collision/solid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/box_mesh.hpp"

namespace kinship::collision::sphere_cover_test {
namespace {

constexpr std::uint64_t kSeed = 5;

const std::vector<Shape> kShapes = {BoxShape{{0.1, 0.1, 0.1}}, BoxShape{{0.02, 0.4, 1.0}},
                                    CylinderShape{0.05, 0.4},  CylinderShape{0.3, 0.02},
                                    SphereShape{0.2},          CapsuleShape{0.05, 0.3},
                                    CapsuleShape{0.1, 1e-3}};

/// How far a point lies within a shape, m; below 0 outside.
double depth(const Shape& shape, const Eigen::Vector3d& p) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return (box->size / 2 - p.cwiseAbs()).minCoeff();
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return std::min(cylinder->radius_m - std::hypot(p.x(), p.y()),
                    cylinder->length_m / 2 - std::abs(p.z()));
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return sphere->radius_m - p.norm();
  const auto& capsule = std::get<CapsuleShape>(shape);
  const double beyond = std::max(std::abs(p.z()) - capsule.length_m / 2, 0.0);
  return capsule.radius_m - std::hypot(p.x(), p.y(), beyond);
}

bool holds(const std::vector<CoverSphere>& cover, const Eigen::Vector3d& p) {
  return std::ranges::any_of(cover, [&](const CoverSphere& sphere) {
    return (p - sphere.center).norm() <= sphere.outer_m;
  });
}

TEST(SphereCover, HoldsEveryPointOfAShapeAndNothingElseWithinItsInnerSpheres) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> uniform(-0.7, 0.7);
  for (const Shape& shape : kShapes)
    for (const int most : {1, 2, 7, 16}) {
      const std::vector<CoverSphere> cover = cover_shape(shape, most);
      ASSERT_LE(cover.size(), static_cast<std::size_t>(most));
      for (int i = 0; i < 20000; ++i) {
        Eigen::Vector3d p(uniform(generator), uniform(generator), uniform(generator));
        p *= std::abs(uniform(generator));
        if (depth(shape, p) >= 0) {
          ASSERT_TRUE(holds(cover, p)) << shape.index() << ", " << p.transpose();
          continue;
        }
        for (const CoverSphere& sphere : cover)
          ASSERT_GT((p - sphere.center).norm(), sphere.inner_m) << shape.index();
      }
    }
}

TEST(SphereCover, GetsCloserWithMoreSpheres) {
  for (const Shape& shape : {kShapes[1], kShapes[2], kShapes[5]}) {
    const auto largest = [&](int most) {
      double outer = 0;
      for (const CoverSphere& sphere : cover_shape(shape, most))
        outer = std::max(outer, sphere.outer_m);
      return outer;
    };
    EXPECT_LT(largest(16), 0.5 * largest(1));
  }
}

TEST(SphereCover, HoldsEveryPointOfTriangles) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Eigen::Matrix3Xd box = test::BoxMesh({0.1, 0.5, 0.3}).triangles();
  for (const int most : {1, 12, 64}) {
    const std::vector<CoverSphere> cover = cover_triangles(box, most);
    ASSERT_EQ(cover.size(), static_cast<std::size_t>(most));
    for (int i = 0; i < 5000; ++i) {
      const Eigen::Index first = 3 * static_cast<Eigen::Index>(generator() % 12);
      double a = uniform(generator), b = uniform(generator);
      if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
      }
      const Eigen::Vector3d p =
          (1 - a - b) * box.col(first) + a * box.col(first + 1) + b * box.col(first + 2);
      ASSERT_TRUE(holds(cover, p));
    }
  }
}

}  // namespace
}  // namespace kinship::collision::sphere_cover_test
