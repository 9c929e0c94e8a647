#include "client/experiments/studies/planar_scene.hpp"

#include <gtest/gtest.h>

#include <set>

#include "client/experiments/studies/study.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::planar_scene_test {
namespace {

constexpr std::uint64_t kSeed = 77;  // of no set of instances
constexpr std::uint32_t kInstances = 5;

models::LoadedRobot robot_named(const std::string& name) {
  const std::string folder = test::source_dir() + "/robots/models/" + name;
  return models::load_robot({.source = folder}).value_or_throw();
}

class PlanarStudies : public testing::TestWithParam<const char*> {};

TEST_P(PlanarStudies, EveryArmStartsFreeWithinLimitsAndEqualSeedsGiveEqualProblems) {
  const Study& study = find_study(GetParam());
  for (const StudyRobot& placed : study.robots) {
    const models::LoadedRobot robot = robot_named(placed.model);
    const DrawInstance draw = study.make_instances(robot, placed);
    const DrawInstance again = study.make_instances(robot, placed);
    for (std::uint32_t index = 0; index < kInstances; ++index) {
      const Problem problem = draw(kSeed, index);
      collision::CollisionWorld world(
          robot.chain, robot.shapes,
          {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
      EXPECT_TRUE(robot.chain.within_limits(problem.start)) << problem.name;
      EXPECT_FALSE(world.collides(problem.start)) << problem.name;
      EXPECT_EQ(json::to_json(problem), json::to_json(again(kSeed, index)));
    }
  }
}

TEST_P(PlanarStudies, ScenesDoNotDependOnTheArmUnlessDrawnAgain) {
  const Study& study = find_study(GetParam());
  const auto draw = [&](std::size_t robot, std::uint32_t index) {
    const StudyRobot& placed = study.robots.at(robot);
    return study.make_instances(robot_named(placed.model), placed)(kSeed, index);
  };
  int compared = 0;
  for (std::uint32_t index = 0; index < kInstances; ++index) {
    const Problem first = draw(0, index), second = draw(2, index);
    if (first.name != second.name)
      continue;
    ++compared;
    EXPECT_TRUE(first.T_task_goal->isApprox(*second.T_task_goal)) << first.name;
    EXPECT_TRUE(
        first.scene.objects.at(0).T_task_object.isApprox(second.scene.objects.at(0).T_task_object));
  }
  EXPECT_GT(compared, 0);
}

INSTANTIATE_TEST_SUITE_P(Every, PlanarStudies, testing::Values("planar", "planar_p1", "open_table"),
                         [](const auto& test) { return std::string(test.param); });

TEST(PlanarScene, InstancesOfOneSetDiffer) {
  const Study& study = find_study("planar");
  const DrawInstance draw =
      study.make_instances(robot_named(study.robots[0].model), study.robots[0]);
  EXPECT_FALSE(draw(kSeed, 0).start.isApprox(draw(kSeed, 1).start));
  EXPECT_FALSE(draw(kSeed, 0).T_task_goal->isApprox(*draw(kSeed, 1).T_task_goal));
}

TEST(PlanarScene, AnArmThatCannotReachTheStartIsSaid) {
  const Study& study = find_study("planar");
  StudyRobot far = study.robots[0];
  far.T_task_base.translation().x() = -3;
  far.start.resize(0);  // searched, as for a study that is not frozen
  try {
    study.make_instances(robot_named(far.model), far);
    FAIL() << "an arm 3 m away has no start";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
    EXPECT_NE(std::string(failure.what()).find("planar_5r_a"), std::string::npos);
  }
}

TEST(Studies, NoSeedServesTwoSets) {
  std::set<std::uint64_t> seeds;
  for (const InstanceSet set :
       {InstanceSet::Calibration, InstanceSet::Tuning, InstanceSet::Test, InstanceSet::Order})
    EXPECT_TRUE(seeds.insert(seed_of(set, 0)).second);
  for (std::size_t robot = 0; robot < 8; ++robot)
    EXPECT_TRUE(seeds.insert(seed_of(InstanceSet::Learning, robot)).second);
}

TEST(Studies, AnUnknownOneIsRefusedWithTheKnownOnes) {
  try {
    find_study("shelf");
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("planar"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::experiments::planar_scene_test
