#include "robots/geometry/geometry_doubts.hpp"

#include <gtest/gtest.h>

#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/box_mesh.hpp"

namespace kinship::geometry::geometry_doubts_test {
namespace {

const std::string kBox = "<geometry><box size='0.1 0.1 0.4'/></geometry>";
const std::string kSolid = "<collision>" + kBox + "</collision>";
const std::string kDrawn = "<visual><origin xyz='0 0 0.2'/>" + kBox + "</visual>";

/// An arm of two links of 0.5 m that reaches 1 m.
RobotDescription describe(const std::string& base, const std::string& upper,
                          const std::string& fore) {
  const auto joint = [](const std::string& parent, const std::string& child,
                        const std::string& type) {
    return "<joint name='to_" + child + "' type='" + type + "'><parent link='" + parent +
           "'/><child link='" + child + "'/><origin xyz='" +
           std::string(child == "upper" ? "0" : "1") +
           " 0 0'/><axis xyz='0 0 1'/>"
           "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  };
  RobotDescription description;
  description.label = "arm";
  description.urdf = "<robot name='arm'><link name='base'>" + base + "</link><link name='upper'>" +
                     upper + "</link><link name='fore'>" + fore + "</link>" +
                     joint("base", "upper", "revolute") + joint("upper", "fore", "revolute") +
                     "</robot>";
  description.base_link = "base";
  description.tip_link = "fore";
  return description;
}

struct Read {
  kinematics::Chain chain;
  RobotShapes shapes;
};

Read read(const RobotDescription& description, const MeshSource& meshes = refuse_mesh) {
  const kinematics::RobotModel robot = kinematics::read_model(description).value_or_throw();
  return {robot.chain, read_shapes(robot, meshes).value_or_throw()};
}

std::string doubts_of(const Read& robot) {
  std::string text;
  for (const std::string& doubt : find_doubts(robot.chain, robot.shapes))
    text += doubt + "\n";
  return text;
}

/// A mesh of 40 x 40 x 400 of its own units.
Result<std::optional<Eigen::Matrix3Xd>> long_box(const std::string& /*uri*/) {
  return std::optional<Eigen::Matrix3Xd>(test::BoxMesh({40, 40, 400}).triangles());
}

std::string mesh(const std::string& scale) {
  return "<collision><geometry><mesh filename='a.stl'" +
         (scale.empty() ? "" : " scale='" + scale + "'") + "/></geometry></collision>";
}

TEST(GeometryDoubts, ARobotWithSolidsForAllThatIsDrawnHasNone) {
  EXPECT_EQ(doubts_of(read(describe(kSolid + kDrawn, kSolid, kSolid))), "");
  EXPECT_EQ(doubts_of(read(describe("", kSolid, ""))), "") << "what is not drawn is a frame";
}

TEST(GeometryDoubts, AMovingLinkWithVisualsOnlyIsNamedAndRefusedForPlanning) {
  const Read robot = read(describe(kSolid, kDrawn, kSolid));
  EXPECT_NE(doubts_of(robot).find("link 'upper' has <visual> and no <collision>"),
            std::string::npos)
      << doubts_of(robot);
  EXPECT_NE(doubts_of(robot).find("--collision-from-visual"), std::string::npos);
  const auto missing = find_missing_solids(robot.chain, robot.shapes);
  ASSERT_TRUE(missing);
  EXPECT_NE(missing->message.find("'upper'"), std::string::npos) << missing->message;
}

TEST(GeometryDoubts, AStandingLinkWithVisualsOnlyIsNamedAndNotRefused) {
  const Read robot = read(describe(kDrawn, kSolid, kSolid));
  EXPECT_NE(doubts_of(robot).find("link 'base' has <visual>"), std::string::npos);
  EXPECT_FALSE(find_missing_solids(robot.chain, robot.shapes));
}

TEST(GeometryDoubts, ARobotWithoutAnyShapeIsNamedAndNotRefused) {
  const Read robot = read(describe("", "", ""));
  EXPECT_NE(doubts_of(robot).find("no link has a solid"), std::string::npos) << doubts_of(robot);
  EXPECT_FALSE(find_missing_solids(robot.chain, robot.shapes));
}

TEST(GeometryDoubts, AMeshAThousandTimesTooLargeOrTooSmallIsNamedWithItsSize) {
  const std::string large = doubts_of(read(describe(kSolid, mesh(""), kSolid), long_box));
  EXPECT_NE(large.find("link 'upper' of an arm that reaches 1 m is 400 m long"), std::string::npos)
      << large;
  EXPECT_NE(large.find("scale=\"0.001 0.001 0.001\""), std::string::npos);
  EXPECT_EQ(doubts_of(read(describe(kSolid, mesh("0.001 0.001 0.001"), kSolid), long_box)), "");
  const std::string small =
      doubts_of(read(describe(kSolid, mesh("0.000001 0.000001 0.000001"), kSolid), long_box));
  EXPECT_NE(small.find("link 'upper' of an arm that reaches 1 m is only 0.4 mm long"),
            std::string::npos)
      << small;
}

TEST(GeometryDoubts, AMovingLinkOfFiftyTimesTheReachIsRefusedAndAStandingOneIsNot) {
  const auto box = [](const std::string& size) {
    return "<collision><geometry><box size='" + size + "'/></geometry></collision>";
  };
  const auto fault = [&](const std::string& base, const std::string& upper) {
    const Read robot = read(describe(box(base), box(upper), kSolid));
    const auto error = find_faults(robot.chain, robot.shapes);
    return error ? error->message : std::string();
  };
  EXPECT_EQ(fault("0.1 0.1 0.1", "98 0.1 0.1"), "");
  EXPECT_EQ(fault("0.1 0.1 0.1", "102 0.1 0.1"),
            "link 'upper' of an arm that reaches 1 m is 102 m long and sticks out 51 m from its "
            "origin; these are probably millimetres (0.051 m): a mesh in mm needs scale=\"0.001 "
            "0.001 0.001\" in the URDF; more than 50 times the reach is taken for no link");
  EXPECT_EQ(fault("400 400 0.1", "0.1 0.1 0.1"), "");
}

TEST(GeometryDoubts, ATransferFrameBeyondTenTimesTheReachIsRefusedAndANearerOneIsNamed) {
  const auto with_tool = [](double z_m) {
    RobotDescription description = describe(kSolid, kSolid, kSolid);
    description.T_tip_transfer.translation().z() = z_m;
    return read(description);
  };
  EXPECT_EQ(doubts_of(with_tool(1.9)), "");
  EXPECT_EQ(doubts_of(with_tool(2.5)),
            "the transfer frame is 2.5 m away from its tip link 'fore', of an arm that reaches 1 "
            "m; lengths are m\n")
      << "and nothing is small beside such a tool";
  EXPECT_FALSE(find_impossible_lengths(with_tool(9.9).chain));
  const auto error = find_impossible_lengths(with_tool(125).chain);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message.find("the transfer frame is 125 m away from its tip link 'fore', of an "
                                "arm that reaches 1 m; these are probably millimetres (0.125 m)"),
            0U)
      << error->message;
  EXPECT_NE(error->message.find("at most 10 times the reach"), std::string::npos);
}

TEST(GeometryDoubts, AChainInMillimetresIsRefusedAndALongOneIsNamed) {
  const auto of_length = [](const std::string& metres) {
    RobotDescription description = describe(kSolid, kSolid, kSolid);
    const std::string metre = "xyz='1 0 0'";
    description.urdf.replace(description.urdf.find(metre), metre.size(),
                             "xyz='" + metres + " 0 0'");
    return read(description);
  };
  EXPECT_FALSE(find_impossible_lengths(of_length("60").chain));
  EXPECT_NE(doubts_of(of_length("60")).find("the arm reaches 60 m from its base, stretched out"),
            std::string::npos);
  EXPECT_EQ(doubts_of(of_length("40")).find("the arm reaches"), std::string::npos);
  const auto error = find_impossible_lengths(of_length("1000").chain);
  ASSERT_TRUE(error);
  EXPECT_NE(error->message.find("reaches 1e+03 m from its base, stretched out; these are probably "
                                "millimetres (1 m)"),
            std::string::npos)
      << error->message;
}

TEST(GeometryDoubts, AFarPlaceIsToldWithItsDistance) {
  const Read robot = read(describe(kSolid, kSolid, kSolid));
  EXPECT_EQ(describe_far_place(robot.chain, {0, 9, 0}), "") << "as a frame that is mistaken";
  EXPECT_EQ(describe_far_place(robot.chain, {0, 420, 0}),
            "it is 420 m away from the robot's base, which gets 1 m far; these are probably "
            "millimetres (0.42 m)");
  EXPECT_EQ(describe_far_place(robot.chain, {0, 0, 5000}),
            "it is 5e+03 m away from the robot's base, which gets 1 m far; lengths are m");
}

TEST(GeometryDoubts, AFloorOfTheRobotsOwnMayBeLargeAndATableInMillimetresMayNot) {
  const auto box = [](const std::string& size) {
    return "<collision><geometry><box size='" + size + "'/></geometry></collision>";
  };
  EXPECT_EQ(doubts_of(read(describe(box("20 20 0.1"), kSolid, kSolid))), "");
  EXPECT_NE(doubts_of(read(describe(box("800 800 50"), kSolid, kSolid))).find("link 'base'"),
            std::string::npos);
}

TEST(GeometryDoubts, AChainWhoseTipLiesOnItsOnlyAxisHasNoneForThat) {
  RobotDescription description = describe("", kSolid, kSolid);
  description.tip_link = "upper";
  description.base_link = "base";
  EXPECT_EQ(doubts_of(read(description)), "");
}

TEST(GeometryDoubts, AMeshScaledByZeroOrWithoutAreaIsRefusedByLinkName) {
  const auto with_mesh = [](const std::string& scale) {
    return kinematics::read_model(describe(kSolid, mesh(scale), kSolid)).value_or_throw();
  };
  const auto scaled = read_shapes(with_mesh("1 1 0"), long_box);
  ASSERT_FALSE(scaled);
  EXPECT_NE(scaled.error().message.find("link 'upper': mesh 'a.stl': its scale has a 0"),
            std::string::npos)
      << scaled.error().message;
  const auto line = read_shapes(with_mesh(""), [](const std::string&) {
    return Result<std::optional<Eigen::Matrix3Xd>>(
        std::optional<Eigen::Matrix3Xd>(test::BoxMesh({1, 0, 0}).triangles()));
  });
  ASSERT_FALSE(line);
  EXPECT_NE(line.error().message.find("no area"), std::string::npos) << line.error().message;
}

TEST(GeometryDoubts, VisualsBecomeSolidsOfLinksThatHaveNoneWhereTheyAreDrawn) {
  RobotDescription description = describe(kSolid + kDrawn, kDrawn, "");
  description.urdf = with_visual_solids(description.urdf).value_or_throw();
  const Read robot = read(description);
  EXPECT_EQ(doubts_of(robot), "");
  ASSERT_EQ(robot.shapes.shapes.size(), 2U);
  EXPECT_TRUE(robot.shapes.shapes[1].T_link_shape.translation().isApprox(Eigen::Vector3d(0, 0, 0.2),
                                                                         1e-12));
  const auto extents = link_extents(robot.chain, robot.shapes);
  ASSERT_EQ(extents.size(), 3U);
  EXPECT_EQ(extents[0].from, SolidsFrom::Collision);
  EXPECT_EQ(extents[1].from, SolidsFrom::Visual);
  EXPECT_EQ(extents[2].from, SolidsFrom::Nothing);
  EXPECT_TRUE(extents[1].size_m.isApprox(Eigen::Vector3d(0.1, 0.1, 0.4), 1e-12));
  EXPECT_FALSE(with_visual_solids("<robot"));
}

TEST(GeometryDoubts, VisualsOfLinksThatNeedNoSolidAreLeft) {
  RobotDescription description = describe("", kDrawn, kDrawn);
  description.urdf = with_visual_solids(description.urdf, {"upper"}).value_or_throw();
  const Read robot = read(description);
  ASSERT_EQ(robot.shapes.shapes.size(), 1U);
  ASSERT_EQ(robot.shapes.visual_only.size(), 1U);
  EXPECT_EQ(robot.chain.links()[static_cast<std::size_t>(robot.shapes.visual_only[0])].name,
            "upper");
}

TEST(GeometryDoubts, AnObstacleBeyondAllThatTheRobotCanTouchIsNamed) {
  const Read robot = read(describe(kSolid, kSolid, kSolid));
  const auto at = [](const std::string& name, double x_m) {
    SceneObject object{name, BoxShape{Eigen::Vector3d::Constant(0.2)}};
    object.T_task_object.translation().x() = x_m;
    return object;
  };
  Scene scene;
  scene.objects = {at("near", 1.2), at("far", 500)};
  const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  const auto said = find_scene_doubts(robot.chain, robot.shapes, origin, scene, {});
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].find("'far' is 500 m away"), 0U) << said[0];
  EXPECT_NE(said[0].find("these are probably millimetres (0.5 m)"), std::string::npos) << said[0];
  const Eigen::Isometry3d there(Eigen::Translation3d(500, 0, 0));
  EXPECT_EQ(find_scene_doubts(robot.chain, robot.shapes, there, scene, {})[0].find("'near'"), 0U);
  AttachedObject rod;
  rod.link = "fore";
  rod.shape = BoxShape{{1000, 0.1, 0.1}};
  EXPECT_TRUE(find_scene_doubts(robot.chain, robot.shapes, origin, scene, {rod}).empty())
      << "what the hand holds gets there";
}

TEST(GeometryDoubts, AnObstacleAHundredTimesAsLongAsTheRobotReachesIsNamed) {
  const Read robot = read(describe(kSolid, kSolid, kSolid));
  Scene scene;
  scene.objects = {{"hall", BoxShape{{90, 90, 0.1}}}, {"table", BoxShape{{800, 1200, 100}}}};
  const auto said =
      find_scene_doubts(robot.chain, robot.shapes, Eigen::Isometry3d::Identity(), scene, {});
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].find("'table' is 1.2e+03 m long"), 0U) << said[0];
  EXPECT_NE(said[0].find("these are probably millimetres (1.2 m)"), std::string::npos) << said[0];
}

}  // namespace
}  // namespace kinship::geometry::geometry_doubts_test
