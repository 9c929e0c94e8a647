#include "robots/geometry/link_meshes.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "proto/types/limits.hpp"
#include "robots/geometry/known_shapes.hpp"
#include "tests/support/box_mesh.hpp"

namespace kinship::geometry::link_meshes_test {
namespace {

constexpr std::uint64_t kSeed = 72;

/// A sphere of `rings` rings about the origin.
Eigen::Matrix3Xd sphere(int rings, double radius_m) {
  const auto point = [&](int ring, int turn) {
    const double polar = std::numbers::pi * ring / rings,
                 around = 2 * std::numbers::pi * turn / (2 * rings);
    return Eigen::Vector3d(radius_m * std::sin(polar) * std::cos(around),
                           radius_m * std::sin(polar) * std::sin(around),
                           radius_m * std::cos(polar));
  };
  Eigen::Matrix3Xd corners(3, 3 * 2 * 2 * rings * rings);
  Eigen::Index column = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (int turn = 0; turn < 2 * rings; ++turn)
      for (const auto& [a, b] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        corners.col(column++) = point(ring + a, turn + b);
  return corners;
}

/// base - arm, which has a mesh for collision and, if it is another one, a visual.
kinematics::RobotModel robot(const std::string& visual, const std::string& collision) {
  RobotDescription description;
  description.label = "r";
  description.urdf =
      "<robot name='r'><link name='base'/><link name='arm'><visual><geometry><mesh filename='" +
      visual + "' scale='2 2 2'/></geometry><material name='m'><color rgba='1 0.5 0 1'/>" +
      "</material></visual><collision><geometry><mesh filename='" + collision +
      "' scale='2 2 2'/></geometry></collision></link>"
      "<joint name='j' type='revolute'><parent link='base'/><child link='arm'/>"
      "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  description.base_link = "base";
  description.tip_link = "arm";
  return kinematics::read_model(description).value_or_throw();
}

MeshSource source(const Eigen::Matrix3Xd& corners) {
  return [corners](const std::string& uri) -> Result<std::optional<Eigen::Matrix3Xd>> {
    if (uri == "missing.stl")
      return invalid_input("no such file");
    return std::optional(corners);
  };
}

FindMesh in(const std::vector<MeshContent>& contents) {
  return [contents](const Digest& digest) -> std::optional<MeshContent> {
    for (const MeshContent& content : contents)
      if (TriangleMesh::read(content)->digest() == digest)
        return content;
    return std::nullopt;
  };
}

TEST(LinkMeshes, AMeshThatIsAlsoDrawnGoesOnceWithItsColour) {
  const LinkMeshes read = read_link_meshes(robot("arm.stl", "arm.stl"), source(sphere(8, 0.1)));
  ASSERT_EQ(read.meshes.size(), 1U);
  EXPECT_EQ(read.meshes[0].role, MeshRole::Both);
  EXPECT_EQ(read.meshes[0].rgba, (std::vector<double>{1, 0.5, 0, 1}));
  EXPECT_TRUE(read.notes.empty());
  ASSERT_EQ(read.contents.size(), 1U);
  const TriangleMesh mesh = TriangleMesh::read(read.contents[0]).value_or_throw();
  EXPECT_EQ(mesh.digest(), read.meshes[0].content);
  EXPECT_NEAR(mesh.corners().colwise().norm().maxCoeff(), 0.2, 1e-6) << "the scale is in it";
}

TEST(LinkMeshes, TwoNamesOfOneContentAreOneContent) {
  const LinkMeshes read = read_link_meshes(robot("seen.stl", "arm.stl"), source(sphere(8, 0.1)));
  ASSERT_EQ(read.meshes.size(), 2U);
  EXPECT_EQ(read.meshes[0].role, MeshRole::Collision);
  EXPECT_EQ(read.meshes[1].role, MeshRole::Visual);
  EXPECT_EQ(read.meshes[0].content, read.meshes[1].content);
  EXPECT_EQ(read.contents.size(), 1U);
}

TEST(LinkMeshes, VisualsOverTheCapAreSimplifiedAndMeshesForCollisionNever) {
  const Eigen::Matrix3Xd fine = sphere(80, 0.1);  // 25 600 triangles
  const LinkMeshes read = read_link_meshes(robot("seen.stl", "arm.stl"), source(fine));
  ASSERT_EQ(read.meshes.size(), 2U);
  EXPECT_EQ(read.meshes[0].error_m, 0);
  EXPECT_GT(read.meshes[1].error_m, 0);
  EXPECT_FALSE(check_link_meshes(read.meshes));
  const auto find = in(read.contents);
  EXPECT_GT(TriangleMesh::read(*find(read.meshes[0].content))->triangles().size() / 3, 25'000U);
  EXPECT_LE(TriangleMesh::read(*find(read.meshes[1].content))->triangles().size() / 3,
            kMaxVisualTriangles);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("of 25600 triangles go, within"), std::string::npos)
      << read.notes[0];
}

TEST(LinkMeshes, WhatCannotGoStaysAndSaysWhy) {
  const LinkMeshes missing =
      read_link_meshes(robot("missing.stl", "missing.stl"), source(sphere(8, 0.1)));
  EXPECT_TRUE(missing.meshes.empty());
  ASSERT_EQ(missing.notes.size(), 1U);
  EXPECT_EQ(missing.notes[0], "mesh 'missing.stl' of link 'arm' stays here: no such file");
  std::mt19937 generator(kSeed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const Eigen::Matrix3Xd noise = Eigen::Matrix3Xd::NullaryExpr(
      3, 3 * 60'000, [&] { return coordinate(generator); });  // 2.9 MB that cannot be compressed
  const LinkMeshes large = read_link_meshes(robot("arm.stl", "arm.stl"), source(noise));
  EXPECT_TRUE(large.meshes.empty());
  ASSERT_EQ(large.notes.size(), 1U);
  EXPECT_NE(large.notes[0].find("compressed, are over 524288"), std::string::npos)
      << large.notes[0];
}

TEST(Simplify, EveryPointIsWithinTheErrorOfTheMeshAndTheCapHolds) {
  const Eigen::Matrix3Xd fine = sphere(60, 0.5);
  for (const std::size_t most : {5000UL, 800UL, 60UL}) {
    const SimplifiedMesh simple = simplify(fine, most);
    const auto triangles = static_cast<std::size_t>(simple.corners.cols() / 3);
    EXPECT_LE(triangles, most);
    EXPECT_GT(triangles, most / 20);
    EXPECT_LT(simple.error_m, 0.5);
    for (Eigen::Index i = 0; i < simple.corners.cols(); i += 3) {
      const Eigen::Vector3d middle = simple.corners.middleCols(i, 3).rowwise().mean();
      // The mesh's chords lie up to 0.4 mm within the sphere.
      EXPECT_LT(std::abs(middle.norm() - 0.5), simple.error_m + 4e-4);
    }
  }
  EXPECT_EQ(simplify(fine, 20'000).corners, fine);
  EXPECT_EQ(simplify(fine, 20'000).error_m, 0);
}

TEST(KnownShapesByMeshes, AreExactOnceAllMeshesForCollisionAreHere) {
  kinematics::RobotModel arm = robot("seen.stl", "arm.stl");
  const LinkMeshes read = read_link_meshes(arm, source(sphere(8, 0.1)));
  arm.description.meshes = read.meshes;
  arm.description.mesh_solids.solids = {{"arm", SphereShape{0.3}}};
  EXPECT_TRUE(names_all_meshes(arm));
  EXPECT_EQ(read_known_shapes(arm)->grade, GeometryGrade::Approximate);
  EXPECT_EQ(read_known_shapes(arm, in({}))->grade, GeometryGrade::Approximate);
  const KnownShapes exact = read_known_shapes(arm, in(read.contents)).value_or_throw();
  EXPECT_EQ(exact.grade, GeometryGrade::Exact);
  EXPECT_EQ(describe(exact), "1 link by the triangles of their meshes");
  ASSERT_EQ(exact.shapes.shapes.size(), 1U);
  EXPECT_EQ(exact.shapes.shapes[0].triangles->cols(), 3 * 256);
  EXPECT_TRUE(exact.shapes.left_out.empty());
  arm.description.meshes.erase(arm.description.meshes.begin());  // a visual alone is none
  EXPECT_FALSE(names_all_meshes(arm));
  EXPECT_EQ(read_known_shapes(arm, in(read.contents))->grade, GeometryGrade::Approximate);
}

}  // namespace
}  // namespace kinship::geometry::link_meshes_test
