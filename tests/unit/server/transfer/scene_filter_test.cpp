#include "server/transfer/scene_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "robots/kinematics/urdf.hpp"
#include "tests/support/parallelogram_arm.hpp"

namespace kinship::transfer::scene_filter_test {
namespace {

/// A column with a beam of two links of 0.5 m that turns in the plane z = 0.1; the transfer frame
/// is the beam's end.
struct Beam {
  Beam() {
    RobotDescription description;
    description.label = "beam";
    description.urdf = R"(<robot name='beam'>
      <link name='column'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>
      <link name='upper'><collision><origin xyz='0.25 0 0'/>
        <geometry><box size='0.5 0.04 0.04'/></geometry></collision></link>
      <link name='fore'><collision><origin xyz='0.25 0 0'/>
        <geometry><box size='0.5 0.04 0.04'/></geometry></collision></link>
      <joint name='j1' type='revolute'><parent link='column'/><child link='upper'/>
        <origin xyz='0 0 0.1'/><axis xyz='0 0 1'/>
        <limit lower='-3' upper='3' effort='1' velocity='1'/></joint>
      <joint name='j2' type='revolute'><parent link='upper'/><child link='fore'/>
        <origin xyz='0.5 0 0'/><axis xyz='0 0 1'/>
        <limit lower='-2.8' upper='2.8' effort='1' velocity='1'/></joint></robot>)";
    description.base_link = "column";
    description.tip_link = "fore";
    description.T_tip_transfer.translation().x() = 0.5;
    chain = kinematics::read_chain(description).value_or_throw();
    shapes = geometry::read_shapes(kinematics::read_model(description).value_or_throw())
                 .value_or_throw();
  }
  SceneFilter filter(const RecordedScene& scene,
                     const Eigen::Isometry3d& T_task_base = Eigen::Isometry3d::Identity()) const {
    return scene_filter({*chain, shapes}, scene, T_task_base);
  }

  std::optional<kinematics::Chain> chain;
  geometry::RobotShapes shapes;
};

Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

const Eigen::Vector2d kAhead(0, 0), kLeft(1.5, 0), kFolded(0, 2.79);
const SceneObject kPost{"post", CylinderShape{0.05, 1}, at(0.8, 0, 0)};
const SceneObject kTable{"table", BoxShape{{3, 3, 0.1}}, at(0, 0, -0.09)};

TEST(SceneFilter, LeavesOutWhatTouchesAnObject) {
  const Beam beam;
  const SceneFilter filter = beam.filter({{kPost}, {}, {}});
  ASSERT_TRUE(filter.keep);
  EXPECT_FALSE(filter.keep(kAhead));
  EXPECT_TRUE(filter.keep(kLeft));
  EXPECT_TRUE(filter.always_touching.empty());
}

TEST(SceneFilter, TheRobotStandsAtItsOwnPlacement) {
  const SceneFilter filter = Beam().filter({{kPost}, {}, {}}, at(0, -0.5, 0));
  EXPECT_TRUE(filter.keep(kAhead));
  EXPECT_FALSE(filter.keep(Eigen::Vector2d(std::atan2(0.5, 0.8), 0)));
}

TEST(SceneFilter, TheRobotHoldsInItsTransferFrameWhatWasHeld) {
  const Beam beam;
  const SceneObject wall{"wall", BoxShape{{0.1, 1, 1}}, at(1.15, 0, 0)};
  EXPECT_TRUE(beam.filter({{wall}, {}, {}}).keep(kAhead));
  RecordedScene scene{{wall}, {{"can", SphereShape{0.2}, at(0.06, 0, 0)}}, {}};
  EXPECT_FALSE(beam.filter(scene).keep(kAhead));
  EXPECT_TRUE(beam.filter(scene).keep(kLeft));
  scene.allowed_collisions.emplace_back("wall", "can");
  EXPECT_TRUE(beam.filter(scene).keep(kAhead));
  // What is held touches the robot itself too: here the upper link of the folded beam.
  EXPECT_FALSE(beam.filter(scene).keep(kFolded));
}

TEST(SceneFilter, SelfCollisionIsAnotherFiltersQuestion) {
  EXPECT_TRUE(Beam().filter({{kPost}, {}, {}}, at(5, 5, 0)).keep(kFolded));
}

TEST(SceneFilter, WhatAlwaysTouchesIsNamedAndNotLookedAt) {
  const Beam beam;
  const SceneFilter filter = beam.filter({{kTable, kPost}, {}, {}});  // the column stands in it
  EXPECT_EQ(filter.always_touching,
            (std::vector<std::pair<std::string, std::string>>{{"column", "table"}}));
  EXPECT_TRUE(filter.keep(kLeft));
  EXPECT_FALSE(filter.keep(kAhead));

  const SceneObject flood{"flood", BoxShape{{5, 5, 5}}, at(0, 0, 0)};
  const SceneFilter drowned = beam.filter({{flood, kPost}, {}, {}});
  EXPECT_EQ(drowned.always_touching.size(), 3U);  // every link
  EXPECT_FALSE(drowned.keep(kAhead));
  EXPECT_TRUE(drowned.keep(kLeft));
}

TEST(SceneFilter, WhatAlwaysTouchesDoesNotHideBehindWhatSometimesDoes) {
  const Beam beam;
  // The upper link turns in the hub; the fore link, which is looked at first, often meets the wall.
  const SceneObject hub{"hub", BoxShape{{0.05, 0.05, 0.02}}, at(0, 0, 0.1)};
  const SceneObject wall{"wall", BoxShape{{0.1, 4, 1}}, at(0.6, 0, 0)};
  const SceneFilter filter = beam.filter({{hub, wall}, {}, {}});
  EXPECT_EQ(filter.always_touching,
            (std::vector<std::pair<std::string, std::string>>{{"upper", "hub"}}));
  EXPECT_FALSE(filter.keep(kAhead));
  EXPECT_TRUE(filter.keep(kLeft));
}

TEST(SceneFilter, LinksBesideTheChainMoveWithIt) {
  const RobotDescription description = test::parallelogram_description();
  const kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  const Eigen::Vector4d low(0, 0, 1.2, 0), up(0, 0, -0.8, 0);  // the weight follows the bend alone
  for (const auto& [there, elsewhere] : {std::pair(up, low), std::pair(low, up)}) {
    const Eigen::Isometry3d T_task_weight = test::followers_of_parallelogram(there).at("weight");
    const SceneObject ball{"ball", SphereShape{0.01},
                           T_task_weight * Eigen::Translation3d(-0.2, 0, 0)};
    const SceneFilter filter = scene_filter(
        {chain, geometry::read_shapes(kinematics::read_model(description).value_or_throw())
                    .value_or_throw()},
        {{ball}, {}, {}}, Eigen::Isometry3d::Identity());
    EXPECT_FALSE(filter.keep(there));
    EXPECT_TRUE(filter.keep(elsewhere));
  }
}

TEST(SceneFilter, WithoutShapesOrObjectsThereIsNone) {
  const Beam beam;
  EXPECT_FALSE(beam.filter({}).keep);
  EXPECT_FALSE(
      scene_filter({*beam.chain, {}}, {{kPost}, {}, {}}, Eigen::Isometry3d::Identity()).keep);
}

}  // namespace
}  // namespace kinship::transfer::scene_filter_test
