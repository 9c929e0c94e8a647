#include "robots/collision/collision_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>

#include "proto/types/failure.hpp"
#include "robots/collision/edge_prover.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::collision_world_test {
namespace {

using namespace test_support;
using Names = std::pair<std::string, std::string>;

constexpr int kJoints = 3;
const Eigen::VectorXd kStraight = angles({0, 0, 0});  // along x, the tip at 1.5 m
const Eigen::VectorXd kTurned = angles({M_PI / 2, 0, 0});

CollisionWorld make_world(const Surroundings& surroundings) {
  return CollisionWorld(toy_chain(kJoints), toy_shapes(kJoints), surroundings);
}

Surroundings with_object(const SceneObject& object) {
  Surroundings surroundings;
  surroundings.scene.objects.push_back(object);
  return surroundings;
}

AttachedObject held_box(const std::string& link, double x, double size_m) {
  AttachedObject object;
  object.name = "held";
  object.link = link;
  object.shape = BoxShape{Eigen::Vector3d::Constant(size_m)};
  object.T_link_object = shift(x);
  return object;
}

TEST(CollisionWorld, AnArmTouchesWhatLiesInItsWay) {
  CollisionWorld world = make_world(with_object(box_at("post", 1.2, 0)));
  EXPECT_TRUE(world.collides(kStraight));
  EXPECT_FALSE(world.collides(kTurned));
  EXPECT_EQ(world.find_contact(kStraight), (Names{"link3", "post"}));
  EXPECT_EQ(world.find_contact(kTurned), std::nullopt);
}

TEST(CollisionWorld, TheNearestPairsAreNamedWithTheirDistances) {
  Surroundings surroundings = with_object(box_at("post", 1.2, 0));
  surroundings.scene.objects.push_back(box_at("far", 5, 0));
  CollisionWorld world = make_world(surroundings);
  const CollisionWorld::NearestPairs touching = world.find_nearest(kStraight);
  ASSERT_TRUE(touching.obstacle);
  EXPECT_EQ(Names(touching.obstacle->first, touching.obstacle->second), (Names{"link3", "post"}));
  EXPECT_EQ(touching.obstacle->distance_m, 0);
  const CollisionWorld::NearestPairs apart = world.find_nearest(kTurned);
  ASSERT_TRUE(apart.obstacle);
  EXPECT_EQ(apart.obstacle->second, "post");
  const auto near = EdgeProver(world).find_near(kTurned, {.clearance_m = kLargestRoom_m});
  EXPECT_TRUE(near.empty()) << "farther than that prover looks";
  EXPECT_GT(apart.obstacle->distance_m, kLargestRoom_m);
  EXPECT_LT(apart.obstacle->distance_m, 1.2);
  EXPECT_FALSE(make_world({}).find_nearest(kTurned).obstacle);
  EXPECT_EQ(world.checks(), 0U);
}

/// The nearest of all pairs is the one that the prover finds, at its distance.
TEST(CollisionWorld, TheNearestPairIsTheProvers) {
  const kinematics::Chain chain = toy_chain(kJoints);
  CollisionWorld world = make_world(with_object(box_at("post", 1.2, 0.4)));
  EdgeProver prover(world);
  std::mt19937_64 generator(5);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::VectorXd q = kinship::test::random_configuration(chain, generator);
    const auto nearest = world.find_nearest(q).obstacle;
    double least_m = kLargestRoom_m;
    for (const NearPair& near : prover.find_near(q, {.clearance_m = kLargestRoom_m}))
      if (near.second == "post")
        least_m = std::min(least_m, near.clearance_m);
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(std::min(nearest->distance_m, kLargestRoom_m), least_m, 0.01 * least_m + 1e-4);
    compared += least_m < kLargestRoom_m ? 1 : 0;
  }
  EXPECT_GT(compared, 20);
}

/// The first joint turns from `first` by `stride` a column.
Eigen::MatrixXd sweep(double first, double stride, Eigen::Index count) {
  Eigen::MatrixXd qs = Eigen::MatrixXd::Zero(kJoints, count);
  for (Eigen::Index i = 0; i < count; ++i)
    qs(0, i) = first + stride * static_cast<double>(i);
  return qs;
}

TEST(CollisionWorld, SeveralAtOnceAreAnsweredAsIfOneAfterTheOther) {
  CollisionWorld world = make_world(with_object(box_at("post", 1.2, 0)));
  for (const bool collide : {false, true})
    for (const Eigen::Index count : {1, 5, 8, 9, 16, 17, 50})
      for (const double first : {-1.0, -0.5, -0.1, -0.08, -0.02, 0.0, 0.05, 0.5}) {
        const Eigen::MatrixXd qs = sweep(first, collide ? 0.007 : 0.02, count);
        Eigen::Index ahead = 0;
        while (ahead < count && world.collides(qs.col(ahead)) == collide)
          ++ahead;
        const std::uint64_t before = world.checks();
        EXPECT_EQ(collide ? world.colliding_ahead(qs) : world.free_ahead(qs), ahead)
            << count << " from " << first;
        EXPECT_EQ(world.checks() - before, static_cast<std::uint64_t>(std::min(ahead + 1, count)));
      }
}

TEST(CollisionWorld, AnglesOfManyTurnsAreAnsweredLikeTheSameWithoutTurns) {
  CollisionWorld world = make_world(with_object(box_at("post", 1.2, 0)));
  for (const double turns : {1.0, -3.0, 1e4, 3e5, 1e7}) {
    const Eigen::VectorXd turned = Eigen::VectorXd::Unit(kJoints, 0) * turns * 2 * M_PI;
    EXPECT_TRUE(world.collides(kStraight + turned)) << turns;
    EXPECT_FALSE(world.collides(kTurned + turned)) << turns;
  }
}

TEST(CollisionWorld, SeveralAtOnceMustFitTheRobot) {
  CollisionWorld world = make_world({});
  EXPECT_THROW(world.free_ahead(Eigen::MatrixXd::Zero(kJoints + 1, 2)), std::invalid_argument);
  Eigen::MatrixXd qs = sweep(0, 0.1, 20);
  qs(1, 19) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(world.free_ahead(qs), std::invalid_argument);
  qs(1, 19) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(world.colliding_ahead(qs), std::invalid_argument);
  EXPECT_EQ(world.free_ahead(Eigen::MatrixXd(kJoints, 0)), 0);
}

Mesh read_box(const Eigen::Vector3d& size) {
  return {"box.stl", Eigen::Vector3d::Ones(),
          std::make_shared<const Eigen::Matrix3Xd>(test::BoxMesh(size).triangles())};
}

TEST(CollisionWorld, AMeshOfASceneIsTouchedWhereItsTrianglesAre) {
  // A plate from (1.2, 0, -0.5) to (1.3, 0.6, 0.5): beside the straight arm, in the turning one's
  // way.
  Surroundings surroundings;
  surroundings.scene.meshes = {{"plate", read_box({0.1, 0.6, 1}), shift(1.2, -0.05)}};
  surroundings.scene.meshes[0].T_task_mesh.translation().z() = -0.5;
  CollisionWorld world = make_world(surroundings);
  EXPECT_TRUE(world.collides(kStraight));
  EXPECT_FALSE(world.collides(kTurned));
  EXPECT_EQ(world.find_contact(kStraight), (Names{"link3", "plate"}));

  surroundings.scene.meshes[0].T_task_mesh.translation().y() = 0.2;
  EXPECT_FALSE(make_world(surroundings).collides(kStraight));
}

TEST(CollisionWorld, APointCloudIsTouchedWhereItsVoxelsAre) {
  // Of the same plate only a grid of points 5 cm apart.
  constexpr double kVoxel_m = 0.02;
  Eigen::Matrix3Xd points(3, 3 * 13 * 21);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Index column = i / 3, row = column / 13;
    points.col(i) << 0.05 * static_cast<double>(i % 3), 0.05 * static_cast<double>(column % 13),
        0.05 * static_cast<double>(row);
  }
  const auto voxels = std::make_shared<const Eigen::Matrix3Xd>(
      geometry::voxels_of(points, kVoxel_m).value_or_throw());
  Surroundings surroundings;
  surroundings.scene.clouds = {{"plate", {"plate.pcd", kVoxel_m, voxels}, shift(1.2, -0.05)}};
  surroundings.scene.clouds[0].T_task_cloud.translation().z() = -0.5;
  CollisionWorld world = make_world(surroundings);
  EXPECT_TRUE(world.collides(kStraight));
  EXPECT_FALSE(world.collides(kTurned));
  EXPECT_EQ(world.find_contact(kStraight), (Names{"link3", "plate"}));

  surroundings.scene.clouds[0].T_task_cloud.translation().y() = 0.2;
  EXPECT_FALSE(make_world(surroundings).collides(kStraight));
  surroundings.scene.clouds[0].cloud.voxels = nullptr;
  EXPECT_THROW(make_world(surroundings), Failure);
}

TEST(CollisionWorld, AHeldMeshMovesWithItsLink) {
  Surroundings surroundings = with_object(box_at("post", 0, 1.9));
  AttachedObject rod = held_box("link3", 0, 1);
  rod.mesh = read_box({0.6, 0.02, 0.02});  // from the link's origin along it
  rod.touch_links = {"link3", "link2"};
  EXPECT_FALSE(make_world(surroundings).collides(kTurned));
  surroundings.attached.push_back(rod);
  surroundings.attached[0].T_link_object = shift(0);
  CollisionWorld world = make_world(surroundings);
  EXPECT_TRUE(world.collides(kTurned));
  EXPECT_FALSE(world.collides(kStraight));
}

TEST(CollisionWorld, AMeshThatWasNotReadIsRefusedByName) {
  Surroundings surroundings;
  surroundings.scene.meshes = {{"plate", {.file = "plate.stl"}}};
  try {
    make_world(surroundings);
    FAIL() << "an obstacle was left out";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.error().message, "scene object 'plate': mesh 'plate.stl' has not been read");
  }
}

TEST(CollisionWorld, WorldsOfTheSameSolidsAnswerLikeWorldsOfTheirOwn) {
  const RobotSolids robot(toy_chain(kJoints), toy_shapes(kJoints));
  for (const double x : {0.7, 1.2, 1.9}) {
    const Surroundings surroundings = with_object(box_at("post", x, 0));
    CollisionWorld shared(robot, surroundings), own = make_world(surroundings);
    for (const Eigen::VectorXd& q : {kStraight, kTurned, angles({0.5, -1, 0.4})})
      EXPECT_EQ(shared.collides(q), own.collides(q)) << x;
  }
}

TEST(CollisionWorld, AnAttachedObjectFollowsItsLink) {
  Surroundings surroundings = with_object(box_at("post", 1.7, 0));
  CollisionWorld empty_handed = make_world(surroundings);
  EXPECT_FALSE(empty_handed.collides(kStraight));

  surroundings.attached = {held_box("link3", 0.2, 0.2)};
  CollisionWorld holding = make_world(surroundings);
  EXPECT_TRUE(holding.collides(kStraight));
  EXPECT_EQ(holding.find_contact(kStraight), (Names{"held", "post"}));
  EXPECT_FALSE(holding.collides(kTurned));
}

TEST(CollisionWorld, AnAttachedObjectMayTouchItsTouchLinks) {
  const Eigen::VectorXd folded = angles({0, 0, 2.6});  // the held box comes back to link 2
  Surroundings surroundings;
  surroundings.attached = {held_box("link3", -0.2, 0.3)};
  CollisionWorld strict = make_world(surroundings);
  EXPECT_EQ(strict.find_contact(folded), (Names{"link2", "held"}));

  surroundings.attached[0].touch_links = {"link2"};
  CollisionWorld lenient = make_world(surroundings);
  EXPECT_EQ(lenient.find_contact(folded), std::nullopt);
}

TEST(CollisionWorld, AnAttachedObjectIsNotCheckedAgainstTheLinkThatHoldsIt) {
  Surroundings surroundings;
  surroundings.attached = {held_box("link3", -0.25, 0.1)};
  EXPECT_FALSE(make_world(surroundings).collides(kStraight));
}

TEST(CollisionWorld, AllowedPairsMayTouchInEitherOrder) {
  Surroundings surroundings = with_object(box_at("post", 1.2, 0));
  surroundings.allowed_collisions = {{"post", "link3"}};
  EXPECT_FALSE(make_world(surroundings).collides(kStraight));
  surroundings.allowed_collisions = {{"link3", "post"}};
  EXPECT_FALSE(make_world(surroundings).collides(kStraight));
  surroundings.allowed_collisions = {{"link2", "post"}};
  EXPECT_TRUE(make_world(surroundings).collides(kStraight));
}

TEST(CollisionWorld, NeverCollidingPairsAreNotChecked) {
  geometry::RobotShapes shapes = toy_shapes(kJoints);
  shapes.never_colliding = {{1, 3}};
  CollisionWorld world(toy_chain(kJoints), shapes, {});
  EXPECT_FALSE(world.collides(angles({0, 2.4, 2.4})));
}

/// A sphere on link 3 so large that it always reaches link 1.
geometry::RobotShapes always_touching_shapes() {
  geometry::RobotShapes shapes = toy_shapes(kJoints);
  shapes.shapes.push_back({3, SphereShape{1.2}, Eigen::Isometry3d::Identity()});
  return shapes;
}

TEST(CollisionWorld, LinksThatAlwaysTouchAreNotChecked) {
  CollisionWorld world(toy_chain(kJoints), always_touching_shapes(), {});
  EXPECT_FALSE(world.collides(kStraight));
}

TEST(CollisionWorld, LinksThatAlwaysTouchAreCheckedIfNeverCollidingPairsAreGiven) {
  geometry::RobotShapes shapes = always_touching_shapes();
  shapes.never_colliding = {{1, 2}};
  CollisionWorld world(toy_chain(kJoints), shapes, {});
  EXPECT_EQ(world.find_contact(kStraight), (Names{"link1", "link3"}));
}

TEST(CollisionWorld, AStandingLinkThatTouchesAnObstacleMakesEveryConfigurationCollide) {
  geometry::RobotShapes shapes = toy_shapes(kJoints);
  shapes.shapes.push_back({0, SphereShape{0.05}, Eigen::Isometry3d::Identity()});
  Surroundings surroundings = with_object(box_at("table", 0, -0.09));
  CollisionWorld blocked(toy_chain(kJoints), shapes, surroundings);
  EXPECT_TRUE(blocked.collides(kTurned));
  EXPECT_EQ(blocked.find_contact(kTurned), (Names{"base", "table"}));

  surroundings.allowed_collisions = {{"base", "table"}};
  CollisionWorld allowed(toy_chain(kJoints), shapes, surroundings);
  EXPECT_EQ(allowed.find_contact(kTurned), std::nullopt);
}

TEST(CollisionWorld, EveryQuestionCountsOneWhateverAnswersIt) {
  geometry::RobotShapes shapes = toy_shapes(kJoints);
  shapes.shapes.push_back({0, SphereShape{0.05}, Eigen::Isometry3d::Identity()});
  CollisionWorld free(toy_chain(kJoints), shapes, {});
  CollisionWorld blocked(toy_chain(kJoints), shapes, with_object(box_at("table", 0, -0.09)));
  for (CollisionWorld* world : {&free, &blocked}) {
    EXPECT_EQ(world->checks(), 0u);
    world->collides(kStraight);              // nothing near
    world->collides(angles({0, 2.4, 2.4}));  // itself
    world->find_contact(kStraight);          // counts none
    EXPECT_EQ(world->checks(), 2u);
  }
}

void expect_refused(const Surroundings& surroundings, const std::string& part_of_message) {
  try {
    make_world(surroundings);
    FAIL() << "accepted; expected: " << part_of_message;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::InvalidInput);
    EXPECT_NE(std::string(failure.what()).find(part_of_message), std::string::npos)
        << failure.what();
  }
}

TEST(CollisionWorld, RefusesWhatCannotBeMeantByName) {
  Surroundings surroundings;
  surroundings.attached = {held_box("leg", 0, 0.1)};
  expect_refused(surroundings, "attached object 'held': no link named 'leg'");
  surroundings.attached = {held_box("link3", 0, 0.1)};
  surroundings.attached[0].touch_links = {"paw"};
  expect_refused(surroundings, "no link named 'paw'");
  surroundings.attached = {held_box("link3", 0, -0.1)};
  expect_refused(surroundings, "attached object 'held': box extent of -0.1 m");
  expect_refused(with_object(box_at("wall", 0, 0, 0)), "scene object 'wall': box extent of 0 m");
  expect_refused(with_object(box_at("wall", NAN, 0)), "scene object 'wall': pose is not finite");
  Surroundings misspelt = with_object(box_at("table", 5, 0));
  misspelt.allowed_collisions = {{"link1", "tabel"}};
  expect_refused(misspelt, "named 'tabel'");
}

TEST(CollisionWorld, RefusesAConfigurationThatIsNone) {
  CollisionWorld world = make_world({});
  EXPECT_THROW(world.collides(angles({0, 0})), std::invalid_argument);
  EXPECT_THROW(world.collides(angles({0, NAN, 0})), std::invalid_argument);
}

/// A closed mesh of a cube about (x, 0, 0).
SceneMesh cube_mesh(const std::string& name, double x, double size_m) {
  SceneMesh mesh;
  mesh.name = name;
  mesh.mesh.triangles = std::make_shared<const Eigen::Matrix3Xd>(
      test::BoxMesh(Eigen::Vector3d::Constant(size_m)).triangles());
  mesh.T_task_mesh = shift(x - size_m / 2, -size_m / 2, -size_m / 2);
  return mesh;
}

using Enclosed = std::vector<CollisionWorld::Enclosed>;

TEST(CollisionWorld, FindsWhatOfTheRobotLiesWhollyWithinAMeshThatNothingTouches) {
  Surroundings surroundings;
  surroundings.scene.meshes = {cube_mesh("room", 0.3, 40), cube_mesh("beside", 30, 1)};
  CollisionWorld world = make_world(surroundings);
  ASSERT_FALSE(world.collides(kStraight));
  Enclosed found = world.find_enclosed(kStraight);
  std::ranges::sort(found, {}, &CollisionWorld::Enclosed::inner);
  EXPECT_EQ(found, (Enclosed{{"link1", "room"}, {"link2", "room"}, {"link3", "room"}}));
}

TEST(CollisionWorld, FindsTheObstacleWithinTheMeshOfALinkWhereverTheLinkIs) {
  geometry::RobotShapes shapes = toy_shapes(kJoints);
  const Eigen::Matrix3Xd cube = test::BoxMesh(Eigen::Vector3d::Constant(0.4)).triangles();
  shapes.shapes[2] = {
      3, BoxShape{Eigen::Vector3d::Constant(0.4)}, shift(0), true,
      std::make_shared<const Eigen::Matrix3Xd>(cube.colwise() - Eigen::Vector3d::Constant(0.2))};
  CollisionWorld world(toy_chain(kJoints), shapes, with_object(box_at("post", 1.5, 0)));
  EXPECT_FALSE(world.collides(kStraight)) << "only the surface of a mesh is touched";
  EXPECT_EQ(world.find_enclosed(kStraight), (Enclosed{{"post", "link3"}}));
  EXPECT_EQ(world.find_enclosed(kTurned), Enclosed{});
}

TEST(CollisionWorld, WhatCrossesAMeshOrStandsBesideItIsNotWithinIt) {
  Surroundings surroundings;
  surroundings.scene.meshes = {cube_mesh("crossed", 1.25, 0.2), cube_mesh("beside", 3, 0.5)};
  CollisionWorld world = make_world(surroundings);
  EXPECT_TRUE(world.collides(kStraight));
  EXPECT_EQ(world.find_enclosed(kStraight), Enclosed{});
}

}  // namespace
}  // namespace kinship::collision::collision_world_test
