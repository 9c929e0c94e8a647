#include "client/experiments/studies/kitting_scene.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::kitting_scene_test {
namespace {

constexpr std::uint64_t kSeed = 77;  // of no set of instances

models::LoadedRobot robot_named(const std::string& name) {
  const std::string folder = test::source_dir() + "/robots/models/" + name;
  return models::load_robot({.source = folder}).value_or_throw();
}

const Study& study() { return find_study("kitting"); }

TEST(KittingScene, TenInstancesFillTheTenCompartmentsInAnOrderOfTheirOwn) {
  std::vector<std::size_t> first, second;
  for (std::uint32_t index = 0; index < 10; ++index) {
    first.push_back(compartment_of(kSeed, index));
    second.push_back(compartment_of(kSeed, 10 + index));
  }
  EXPECT_EQ(std::set<std::size_t>(first.begin(), first.end()).size(), kKittingCompartments);
  EXPECT_EQ(std::set<std::size_t>(second.begin(), second.end()).size(), kKittingCompartments);
  EXPECT_NE(first, second);
  EXPECT_LT(*std::max_element(first.begin(), first.end()), kKittingCompartments);
}

TEST(KittingScene, TheRackStandsStillAndPartsLieElsewhereEachTime) {
  std::mt19937_64 generator(kSeed);
  const KittingScene first = draw_kitting_scene(0, generator);
  double least_y = 1, most_y = -1;
  for (int i = 0; i < 50; ++i) {
    const KittingScene other = draw_kitting_scene(0, generator);
    for (std::size_t object = 0; object < other.scene.objects.size(); ++object) {
      const SceneObject& seen = other.scene.objects[object];
      if (!seen.name.starts_with("part_")) {
        EXPECT_TRUE(
            seen.T_task_object.isApprox(first.scene.objects.at(object).T_task_object, 1e-12))
            << seen.name;
      }
    }
    const double y = other.T_task_pick.translation().y();
    least_y = std::min(least_y, y);
    most_y = std::max(most_y, y);
    EXPECT_NEAR(other.T_task_pick.linear()(2, 2), -1, 1e-9);  // downward
    EXPECT_GT(other.T_task_place.linear()(0, 2), 0.99);       // into the rack
    EXPECT_LT((other.T_task_place.translation() - first.T_task_place.translation()).norm(), 0.04);
  }
  EXPECT_LT(least_y, -0.25);
  EXPECT_GT(most_y, 0.25);
}

class EveryRobot : public testing::TestWithParam<std::size_t> {};

TEST_P(EveryRobot, StartsFreeOverThePartAndReachesEveryCompartment) {
  const StudyRobot& placed = study().robots.at(GetParam());
  const models::LoadedRobot robot = robot_named(placed.model);
  const DrawInstance draw = study().make_instances(robot, placed);
  for (std::uint32_t index = 0; index < kKittingCompartments; ++index) {
    const Problem problem = draw(kSeed, index);
    collision::CollisionWorld world(
        robot.chain, robot.shapes,
        {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
    EXPECT_FALSE(world.collides(problem.start)) << problem.name;
    const Eigen::Isometry3d T_task_transfer =
        *problem.T_task_base * kinematics::T_base_transfer(robot.chain, problem.start);
    EXPECT_NEAR(T_task_transfer.linear()(2, 2), -1, 1e-5) << problem.name;
    EXPECT_NEAR(T_task_transfer.translation().z(), T_task_nominal_pick().translation().z(), 1e-5);
    planning::GoalOptions options;
    options.max_configurations = study().settings.max_goals;
    options.seed = problem.seed + 3;
    const auto goals = planning::goal_configurations(
        robot.chain, problem.T_task_base->inverse() * *problem.T_task_goal,
        planning::planning_bounds(robot.chain, problem.start),
        [&](const Eigen::VectorXd& q) { return !world.collides(q); }, options);
    EXPECT_GT(goals.configurations.cols(), 0) << problem.name;
  }
  EXPECT_EQ(json::to_json(draw(kSeed, 3)),
            json::to_json(study().make_instances(robot, placed)(kSeed, 3)));
}

INSTANTIATE_TEST_SUITE_P(Kitting, EveryRobot, testing::Range<std::size_t>(0, 5),
                         [](const auto& test) { return study().robots.at(test.param).model; });

TEST(KittingInstances, ARobotOutOfReachIsSaid) {
  StudyRobot far = study().robots.at(3);
  far.T_task_base.translation().x() = -3;
  EXPECT_THROW(study().make_instances(robot_named(far.model), far)(kSeed, 0), Failure);
  far.start.resize(0);  // searched
  EXPECT_THROW(study().make_instances(robot_named(far.model), far), Failure);
}

}  // namespace
}  // namespace kinship::experiments::kitting_scene_test
