#include "robots/geometry/known_shapes.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "robots/geometry/fitted_shape.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/box_mesh.hpp"

namespace kinship::geometry::known_shapes_test {
namespace {

std::string link_of(const std::string& name, const std::string& geometry) {
  return "<link name='" + name + "'>" +
         (geometry.empty() ? "" : "<collision><geometry>" + geometry + "</geometry></collision>") +
         "</link>";
}

const std::string kMesh = "<mesh filename='arm.stl'/>", kBox = "<box size='1 1 1'/>";

/// base - arm - tip, one joint.
RobotDescription description(const std::string& base, const std::string& arm) {
  RobotDescription robot;
  robot.label = "r";
  robot.urdf = "<robot name='r'>" + link_of("base", base) + link_of("arm", arm) +
               link_of("tip", "") +
               "<joint name='j' type='revolute'><parent link='base'/><child link='arm'/>"
               "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
               "<joint name='f' type='fixed'><parent link='arm'/><child link='tip'/></joint>"
               "</robot>";
  robot.base_link = "base";
  robot.tip_link = "tip";
  return robot;
}

kinematics::Chain chain() { return kinematics::read_chain(description("", "")).value_or_throw(); }

Result<KnownShapes> known(const RobotDescription& robot) {
  return read_known_shapes(kinematics::read_model(robot).value_or_throw());
}

RobotDescription with_solid(RobotDescription robot, const std::string& link) {
  robot.mesh_solids.solids = {{link, SphereShape{0.1}}, {link, BoxShape{{0.1, 0.1, 0.3}}}};
  return robot;
}

TEST(KnownShapes, GradesWhatIsKnown) {
  const auto grade = [](const RobotDescription& robot) { return known(robot).value().grade; };
  EXPECT_EQ(grade(description("", "")), GeometryGrade::None);
  EXPECT_EQ(grade(description("", kMesh)), GeometryGrade::None);
  EXPECT_EQ(grade(description(kBox, kMesh)), GeometryGrade::Partial);
  EXPECT_EQ(grade(with_solid(description(kBox, kMesh), "arm")), GeometryGrade::Approximate);
  EXPECT_EQ(grade(description(kBox, kBox)), GeometryGrade::Exact);
}

TEST(KnownShapes, SaysWhatIsKnownInWords) {
  EXPECT_EQ(describe(known(description("", "")).value()), "no link has a collision shape");
  EXPECT_EQ(describe(known(description(kBox, kBox)).value()), "2 links by exact shapes");
  EXPECT_EQ(describe(known(description(kBox, kMesh)).value()),
            "1 link by exact shapes, 1 link unknown, with meshes that only its clients have");
  RobotDescription robot = with_solid(description(kBox, kMesh), "arm");
  robot.mesh_solids.unfiltered = {{"tip", "base"}};
  EXPECT_EQ(describe(known(robot).value()),
            "1 link by exact shapes, 1 link by 2 solids around meshes (approximate; 1 pair of "
            "links not compared)");
}

TEST(KnownShapes, SolidsAreShapesOfTheirLinkAndPairsAreNotChecked) {
  RobotDescription robot = with_solid(description(kBox, kMesh), "arm");
  robot.mesh_solids.unfiltered = {{"tip", "base"}};
  const RobotShapes shapes = known(robot).value().shapes;
  ASSERT_EQ(shapes.shapes.size(), 3U);
  EXPECT_FALSE(shapes.shapes[0].approximate);
  EXPECT_TRUE(shapes.shapes[1].approximate);
  EXPECT_EQ(shapes.shapes[2].link, chain().find_link("arm"));
  ASSERT_EQ(shapes.never_colliding.size(), 1U);
  EXPECT_EQ(shapes.never_colliding[0],
            std::pair(chain().find_link("base"), chain().find_link("tip")));
  EXPECT_TRUE(shapes.left_out.empty());
}

TEST(KnownShapes, SolidsOfWhatHasNoMeshAreRefused) {
  EXPECT_EQ(known(with_solid(description(kBox, kMesh), "base")).error().message,
            "mesh_solids: link 'base' has no mesh");
  EXPECT_EQ(known(with_solid(description(kBox, kMesh), "hand")).error().message,
            "mesh_solids: no link named 'hand'");
  RobotDescription robot = with_solid(description(kBox, kMesh), "arm");
  robot.mesh_solids.unfiltered = {{"arm", "leg"}};
  EXPECT_EQ(known(robot).error().message, "mesh_solids: no link named 'leg'");
  robot = with_solid(description(kBox, kMesh), "arm");
  robot.mesh_solids.solids[0].shape = SphereShape{-1};
  EXPECT_NE(known(robot).error().message.find("mesh_solids: link 'arm': sphere radius"),
            std::string::npos);
}

TEST(KnownShapes, CoversWhatIsAMesh) {
  const kinematics::RobotModel robot =
      kinematics::read_model(description(kBox, kMesh)).value_or_throw();
  const RobotShapes shapes =
      read_shapes(robot, [](const std::string&) {
        return Result<std::optional<Eigen::Matrix3Xd>>(test::BoxMesh({0.1, 0.2, 0.3}).triangles());
      }).value_or_throw();
  const MeshSolids solids = cover_links(shapes, chain()).value_or_throw();
  ASSERT_FALSE(solids.solids.empty());
  for (const LinkSolid& solid : solids.solids)
    EXPECT_EQ(solid.link, "arm");
  const RobotShapes solid = with_solids(shapes, solids, chain());
  EXPECT_EQ(solid.shapes.size(), 1 + solids.solids.size());
  for (const LinkShape& shape : solid.shapes)
    EXPECT_EQ(shape.triangles, nullptr);
}

TEST(KnownShapes, SolidsThatDoNotHoldTheMeshesAreNoCovers) {
  const RobotDescription named = description(kBox, kMesh);
  const TriangleMesh mesh =
      TriangleMesh::from_corners(test::BoxMesh({0.1, 0.2, 0.3}).triangles()).value_or_throw();
  const auto covers_of = [&](double size_m) {
    RobotDescription robot = named;
    robot.meshes = {{.link = "arm", .role = MeshRole::Collision, .content = mesh.digest()}};
    robot.mesh_solids.solids = {{"arm", BoxShape{{0.1, 0.2, size_m}},
                                 Eigen::Isometry3d(Eigen::Translation3d(0.05, 0.1, size_m / 2))}};
    const auto read =
        read_known_shapes(kinematics::read_model(robot).value_or_throw(), [&](const Digest&) {
          return std::optional(mesh.content());
        }).value_or_throw();
    EXPECT_EQ(read.grade, GeometryGrade::Exact);
    return read.covers;
  };
  EXPECT_EQ(covers_of(0.29), nullptr);
  const auto covers = covers_of(0.3);
  ASSERT_NE(covers, nullptr);
  ASSERT_EQ(covers->shapes.size(), 2U);
  EXPECT_GT(std::get<BoxShape>(covers->shapes[1].shape).size.z(), 0.3) << "as the test was made";
}

/// A robot of one link with as many meshes, each a long triangle across the seam of two solids: it
/// is halved along all of the seam. Other solids, which are all asked each time, are far away.
KnownShapes with_seams(int meshes) {
  Eigen::Matrix3Xd corners(3, 3);
  corners << -1, 1.1, 0.05, 0, 0, 40, 0, 0, 0;
  const TriangleMesh mesh = TriangleMesh::from_corners(corners).value_or_throw();
  std::string collisions;
  RobotDescription robot = description("", "");
  for (int i = 0; i < meshes; ++i) {
    collisions += "<collision><geometry>" + kMesh + "</geometry></collision>";
    robot.meshes.push_back({.link = "arm", .role = MeshRole::Collision, .content = mesh.digest()});
  }
  const std::string arm = "<link name='arm'>";
  robot.urdf.insert(robot.urdf.find(arm) + arm.size(), collisions);
  for (const double x : {-5.0, 5.0})
    robot.mesh_solids.solids.push_back(
        {"arm", BoxShape{{10, 100, 1}}, Eigen::Isometry3d(Eigen::Translation3d(x, 20, 0))});
  while (robot.mesh_solids.solids.size() < 100)
    robot.mesh_solids.solids.push_back(
        {"arm", SphereShape{0.1}, Eigen::Isometry3d(Eigen::Translation3d(-500, 0, 0))});
  return read_known_shapes(kinematics::read_model(robot).value_or_throw(),
                           [&](const Digest&) { return std::optional(mesh.content()); })
      .value_or_throw();
}

TEST(KnownShapes, WhatSolidsHoldIsTestedWithinABoundOfTheRobotNotOfEachMesh) {
  const KnownShapes few = with_seams(1), many = with_seams(20);
  EXPECT_NE(few.covers, nullptr);
  EXPECT_EQ(describe(few), "1 link by the triangles of their meshes");
  EXPECT_EQ(many.grade, GeometryGrade::Exact);
  EXPECT_EQ(many.covers, nullptr);
  EXPECT_EQ(describe(many),
            "1 link by the triangles of their meshes alone (too many to test the solids around "
            "them)");
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(BrokenRule, SoundShapesBreakNone) {
  EXPECT_FALSE(broken_rule(BoxShape{{1, 2, 3}}));
  EXPECT_FALSE(broken_rule(CylinderShape{0.1, 0.2}));
  EXPECT_FALSE(broken_rule(SphereShape{0.1}));
  EXPECT_FALSE(broken_rule(CapsuleShape{0.1, 0}));
}

TEST(BrokenRule, EverySizeMustBePositiveAndFinite) {
  for (const double bad : {0.0, -1.0, kNan, kInfinity, 2 * kMaxShape_m}) {
    EXPECT_TRUE(broken_rule(BoxShape{{bad, 1, 1}})) << bad;
    EXPECT_TRUE(broken_rule(BoxShape{{1, bad, 1}})) << bad;
    EXPECT_TRUE(broken_rule(BoxShape{{1, 1, bad}})) << bad;
    EXPECT_TRUE(broken_rule(CylinderShape{bad, 1})) << bad;
    EXPECT_TRUE(broken_rule(CylinderShape{1, bad})) << bad;
    EXPECT_TRUE(broken_rule(SphereShape{bad})) << bad;
    EXPECT_TRUE(broken_rule(CapsuleShape{bad, 1})) << bad;
  }
  EXPECT_TRUE(broken_rule(CapsuleShape{1, -1}));
}

TEST(BrokenRule, NamesSizeAndValue) {
  EXPECT_EQ(broken_rule(CylinderShape{1, -0.5}),
            "cylinder length of -0.5 m is not between 0 and 1000 m");
}

TEST(HalfExtents, AreThoseOfTheBoxAroundAShape) {
  EXPECT_EQ(half_extents_m(BoxShape{{1, 2, 3}}), Eigen::Vector3d(0.5, 1, 1.5));
  EXPECT_EQ(half_extents_m(CylinderShape{0.25, 3}), Eigen::Vector3d(0.25, 0.25, 1.5));
  EXPECT_EQ(half_extents_m(SphereShape{0.25}), Eigen::Vector3d(0.25, 0.25, 0.25));
  EXPECT_EQ(half_extents_m(CapsuleShape{0.25, 3}), Eigen::Vector3d(0.25, 0.25, 1.75));
}

}  // namespace
}  // namespace kinship::geometry::known_shapes_test
