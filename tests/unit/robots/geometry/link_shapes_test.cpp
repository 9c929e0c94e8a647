#include "robots/geometry/link_shapes.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robots/kinematics/urdf.hpp"
#include "tests/support/box_mesh.hpp"

namespace kinship::geometry::link_shapes_test {
namespace {

/// Two links and a joint between them; the collision elements go into the second.
RobotDescription describe(const std::string& collisions) {
  RobotDescription description;
  description.label = "two_links";
  description.urdf = R"(<robot name="two_links">
    <link name="base"/>
    <link name="arm">)" +
                     collisions + R"(</link>
    <joint name="turn" type="revolute">
      <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/>
    </joint></robot>)";
  description.base_link = "base";
  description.tip_link = "arm";
  return description;
}

std::string collision(const std::string& geometry, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry>" + geometry + "</geometry></collision>";
}

Result<RobotShapes> read(const RobotDescription& description) {
  return read_shapes(kinematics::read_model(description).value_or_throw());
}

TEST(ReadShapes, BlanksTabsAndLineBreaksMayStandAroundANumber) {
  const auto shapes = read(describe(collision("<cylinder radius=' 0.1\t' length='\n0.5 '/>") +
                                    collision("<box size='\t1 2\t3\n'/>")));
  ASSERT_TRUE(shapes) << shapes.error().message;
  EXPECT_EQ(std::get<CylinderShape>(shapes->shapes[0].shape).radius_m, 0.1);
  EXPECT_EQ(std::get<CylinderShape>(shapes->shapes[0].shape).length_m, 0.5);
  EXPECT_EQ(std::get<BoxShape>(shapes->shapes[1].shape).size, Eigen::Vector3d(1, 2, 3));
}

TEST(ReadShapes, ReadsBoxCylinderAndSphereWithTheirPlaces) {
  const auto shapes = read(describe(
      collision("<box size='1 2 3'/>", "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/>") +
      collision("<cylinder radius='0.1' length='0.5'/>") + collision("<sphere radius='0.2'/>")));
  ASSERT_TRUE(shapes) << shapes.error().message;
  ASSERT_EQ(shapes->shapes.size(), 3u);
  EXPECT_EQ(std::get<BoxShape>(shapes->shapes[0].shape).size, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE((shapes->shapes[0].T_link_shape * Eigen::Vector3d(0, -1, 0))
                  .isApprox(Eigen::Vector3d(2, 0, 0), 1e-12));
  EXPECT_EQ(std::get<CylinderShape>(shapes->shapes[1].shape).length_m, 0.5);
  EXPECT_EQ(std::get<SphereShape>(shapes->shapes[2].shape).radius_m, 0.2);
  for (const LinkShape& shape : shapes->shapes)
    EXPECT_EQ(shape.link, 1);
}

TEST(ReadShapes, FusesCapsules) {
  const auto shapes =
      read(describe(collision("<cylinder radius='0.1' length='0.5'/>") +
                    collision("<sphere radius='0.1'/>", "<origin xyz='0 0 0.25'/>") +
                    collision("<sphere radius='0.1'/>", "<origin xyz='0 0 -0.25'/>")));
  ASSERT_TRUE(shapes) << shapes.error().message;
  ASSERT_EQ(shapes->shapes.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<CapsuleShape>(shapes->shapes[0].shape));
}

const std::string kMesh =
    collision("<mesh filename='package://a/b.stl' scale='1 2 -0.5'/>", "<origin xyz='1 0 0'/>");

/// A cube of 2 m whose middle lies at z = 10.
Result<std::optional<Eigen::Matrix3Xd>> cube_for(const std::string& uri) {
  EXPECT_EQ(uri, "package://a/b.stl");
  const Eigen::Matrix3Xd triangles = test::BoxMesh({2, 2, 2}).triangles();
  return std::optional<Eigen::Matrix3Xd>(triangles.colwise() + Eigen::Vector3d(-1, -1, 9));
}

Result<RobotShapes> read_with(const std::string& collisions, const MeshSource& meshes) {
  const RobotDescription description = describe(collisions);
  return read_shapes(kinematics::read_model(description).value_or_throw(), meshes);
}

TEST(ReadShapes, RefusesAMeshByLinkNameUnlessToldWhereItIs) {
  const auto shapes = read(describe(kMesh));
  ASSERT_FALSE(shapes);
  EXPECT_EQ(shapes.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(shapes.error().message, "link 'arm': mesh 'package://a/b.stl' is out of reach here");
}

TEST(ReadShapes, FitsASolidAroundAScaledMesh) {
  const auto shapes = read_with(kMesh + collision("<sphere radius='1'/>"), cube_for);
  ASSERT_TRUE(shapes) << shapes.error().message;
  ASSERT_EQ(shapes->shapes.size(), 2u);
  const LinkShape& fitted = shapes->shapes[0];
  EXPECT_TRUE(fitted.approximate);
  EXPECT_FALSE(shapes->shapes[1].approximate);
  EXPECT_EQ(shapes->shapes[1].triangles, nullptr);
  ASSERT_NE(fitted.triangles, nullptr);
  const Eigen::Matrix3Xd in_link = fitted.T_link_shape * *fitted.triangles;
  EXPECT_EQ(in_link.cols(), 36);
  EXPECT_TRUE(in_link.rowwise().minCoeff().isApprox(Eigen::Vector3d(0, -2, -5.5), 1e-6));
  EXPECT_TRUE(in_link.rowwise().maxCoeff().isApprox(Eigen::Vector3d(2, 2, -4.5), 1e-6));
  const Eigen::Vector3d size = fitted.T_link_shape.linear() * std::get<BoxShape>(fitted.shape).size;
  EXPECT_TRUE(size.cwiseAbs().isApprox(Eigen::Vector3d(2, 4, 1), 1e-6)) << size.transpose();
  EXPECT_TRUE(fitted.T_link_shape.translation().isApprox(Eigen::Vector3d(1, 0, -5), 1e-6));
}

TEST(ReadShapes, RefusesCornersThatAreNoTriangles) {
  const auto shapes =
      read_with(collision("<mesh filename='package://a/b.stl'/>"), [](const std::string&) {
        return Result<std::optional<Eigen::Matrix3Xd>>(Eigen::Matrix3Xd::Ones(3, 8).eval());
      });
  ASSERT_FALSE(shapes);
  EXPECT_NE(shapes.error().message.find("no triangles"), std::string::npos);
}

TEST(ReadShapes, LeavesOutMeshesForWhoHasTheTextOnly) {
  const auto shapes = read_with(kMesh + collision("<sphere radius='1'/>"), leave_out_mesh);
  ASSERT_TRUE(shapes) << shapes.error().message;
  ASSERT_EQ(shapes->shapes.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<SphereShape>(shapes->shapes[0].shape));
}

TEST(ReadShapes, NamesTheLinkOfAMeshThatCannotBeHad) {
  const auto shapes = read_with(kMesh, [](const std::string&) {
    return Error{ErrorCode::NotFound, "gone"};
  });
  ASSERT_FALSE(shapes);
  EXPECT_EQ(shapes.error().code, ErrorCode::NotFound);
  EXPECT_EQ(shapes.error().message, "link 'arm': gone");
}

TEST(ReadShapes, RefusesAScaleThatMakesAMeshEndless) {
  const auto shapes = read_with(
      collision("<mesh filename='package://a/b.stl' scale='1e308 1e308 1e308'/>"), cube_for);
  ASSERT_FALSE(shapes);
  EXPECT_EQ(shapes.error().message, "link 'arm': mesh 'package://a/b.stl': a corner is not finite");
}

TEST(ReadShapes, TakesAVisualMesh) {
  const auto shapes =
      read(describe("<visual><geometry><mesh filename='package://a/b.stl'/></geometry></visual>"));
  ASSERT_TRUE(shapes) << shapes.error().message;
  EXPECT_TRUE(shapes->shapes.empty());
}

TEST(ReadShapes, RefusesSizesThatAreNotPositive) {
  const auto shapes = read(describe(collision("<sphere radius='-0.1'/>")));
  ASSERT_FALSE(shapes);
  EXPECT_EQ(shapes.error().message,
            "link 'arm': sphere radius of -0.1 m is not between 0 and 1000 m");
}

TEST(ReadShapes, RefusesGeometryThatCannotBeRead) {
  const auto shapes = read(describe(collision("<cylinder radius='abc' length='1'/>")));
  ASSERT_FALSE(shapes);
  EXPECT_EQ(
      shapes.error().message,
      "URDF: radius [abc] is not a valid float; Could not parse collision element for Link [arm]");
}

TEST(ReadShapes, TurnsNeverCollidingNamesIntoSortedIndices) {
  RobotDescription description = describe("");
  description.never_colliding = {{"arm", "base"}, {"base", "arm"}, {"arm", "arm"}};
  const auto shapes = read(description);
  ASSERT_TRUE(shapes) << shapes.error().message;
  EXPECT_EQ(shapes->never_colliding, (std::vector<std::pair<int, int>>{{0, 1}}));
}

TEST(ReadShapes, RefusesANeverCollidingPairWithoutALink) {
  RobotDescription description = describe("");
  description.never_colliding = {{"arm", "leg"}};
  const auto shapes = read(description);
  ASSERT_FALSE(shapes);
  EXPECT_NE(shapes.error().message.find("no link named 'leg'"), std::string::npos);
}

TEST(ReadShapes, SaysNothingOnTheTerminal) {
  RobotDescription broken = describe("");
  broken.urdf = "<robot name='x'><link name='a'/><joint/></robot>";
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_FALSE(kinematics::read_model(broken));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace kinship::geometry::link_shapes_test
