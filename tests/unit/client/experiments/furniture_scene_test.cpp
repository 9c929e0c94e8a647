#include "client/experiments/studies/furniture_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::furniture_scene_test {
namespace {

constexpr std::uint64_t kSeed = 77;  // of no set of instances

constexpr FurnitureKind kKinds[] = {FurnitureKind::Shelf, FurnitureKind::TallShelf,
                                    FurnitureKind::Box, FurnitureKind::Cage, FurnitureKind::Table};

models::LoadedRobot robot_named(const std::string& name) {
  const std::string folder = test::source_dir() + "/robots/models/" + name;
  return models::load_robot({.source = folder}).value_or_throw();
}

DrawInstance instances_of(const Study& study, std::size_t robot) {
  const StudyRobot& placed = study.robots.at(robot);
  return study.make_instances(robot_named(placed.model), placed);
}

double yaw_of(const Eigen::Isometry3d& T) { return std::atan2(T(1, 0), T(0, 0)); }

class EveryKind : public testing::TestWithParam<FurnitureKind> {};

TEST_P(EveryKind, StandsWithinItsBoundsAndTheThingIsOnOneOfItsBoards) {
  const Furniture furniture = make_furniture(GetParam());
  std::mt19937_64 generator(kSeed);
  std::set<const Board*> boards;
  double least_x = 1, most_x = -1, most_turn_rad = 0;
  for (int i = 0; i < 200; ++i) {
    const FurnitureScene instance = draw_furniture_scene(GetParam(), generator);
    const Eigen::Vector3d shift =
        instance.T_task_furniture.translation() - Eigen::Vector3d(furniture.nominal_x, 0, 0);
    EXPECT_LE(std::abs(shift.x()), kFurnitureShift_m);
    EXPECT_LE(std::abs(shift.y()), kFurnitureShift_m);
    EXPECT_EQ(shift.z(), 0);
    const double turn_rad = std::abs(yaw_of(instance.T_task_furniture));
    EXPECT_LE(turn_rad, kFurnitureTurn_rad);
    least_x = std::min(least_x, shift.x());
    most_x = std::max(most_x, shift.x());
    most_turn_rad = std::max(most_turn_rad, turn_rad);

    const auto target = std::ranges::find(instance.scene.objects, kTargetName, &SceneObject::name);
    ASSERT_NE(target, instance.scene.objects.end());
    const double height = std::get<CylinderShape>(target->shape).length_m;
    const Eigen::Vector3d foot =
        instance.T_task_furniture.inverse() * target->T_task_object.translation() -
        Eigen::Vector3d(0, 0, height / 2);
    const auto board = std::ranges::find_if(furniture.boards, [&](const Board& each) {
      const Eigen::Vector3d p = foot - each.middle;
      return std::abs(p.x()) <= each.half_x && std::abs(p.y()) <= each.half_y && p.z() >= 0 &&
             p.z() < 0.01;
    });
    ASSERT_NE(board, furniture.boards.end()) << foot.transpose();
    boards.insert(&*board);
    const Eigen::Vector3d approach = instance.T_task_grasp.linear().col(2);
    EXPECT_NEAR(approach.z(), board->approach == Approach::Downward ? -1 : 0, 1e-9);
    EXPECT_LT((instance.T_task_grasp.translation() - target->T_task_object.translation()).norm(),
              0.1);
  }
  EXPECT_EQ(boards.size(), furniture.boards.size());
  EXPECT_LT(least_x, -0.3);
  EXPECT_GT(most_x, 0.3);
  EXPECT_GT(most_turn_rad, 0.9);
}

TEST_P(EveryKind, IsDrawnForEveryRobotWithAFreeHomeAndGoalsUnderTheSeedsOfItsQueries) {
  const Study& study = find_study(study_name(GetParam()));
  ASSERT_EQ(study.robots.size(), 5U);
  for (const StudyRobot& placed : study.robots) {
    const models::LoadedRobot robot = robot_named(placed.model);
    const Problem problem = study.make_instances(robot, placed)(kSeed, 0);
    collision::CollisionWorld world(
        robot.chain, robot.shapes,
        {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
    EXPECT_FALSE(world.collides(problem.start)) << placed.model;
    EXPECT_EQ(problem.start, placed.start);
    planning::GoalOptions options;
    options.max_configurations = study.settings.max_goals;
    for (int seed = 0; seed < 4; ++seed) {
      options.seed = problem.seed + static_cast<std::uint64_t>(seed);
      const auto goals = planning::goal_configurations(
          robot.chain, problem.T_task_base->inverse() * *problem.T_task_goal,
          planning::planning_bounds(robot.chain, problem.start),
          [&](const Eigen::VectorXd& q) { return !world.collides(q); }, options);
      EXPECT_GT(goals.configurations.cols(), 0) << placed.model << ", seed " << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Furniture, EveryKind, testing::ValuesIn(kKinds),
                         [](const auto& test) { return std::string(study_name(test.param)); });

TEST(FurnitureInstances, EqualSeedsGiveEqualProblemsAndInstancesDiffer) {
  const Study& study = find_study("furniture_cage");
  const DrawInstance draw = instances_of(study, 3), again = instances_of(study, 3);
  EXPECT_EQ(json::to_json(draw(kSeed, 1)), json::to_json(again(kSeed, 1)));
  EXPECT_FALSE(draw(kSeed, 1).T_task_goal->isApprox(*draw(kSeed, 2).T_task_goal));
}

TEST(FurnitureInstances, AreTheSameForEveryRobotUnlessDrawnAgain) {
  const Study& study = find_study("furniture_shelf");
  const DrawInstance of_one = instances_of(study, 2), of_another = instances_of(study, 4);
  int compared = 0;
  for (std::uint32_t index = 0; index < 10; ++index) {
    const Problem first = of_one(kSeed, index), second = of_another(kSeed, index);
    const bool is_same = first.T_task_goal->isApprox(*second.T_task_goal);
    EXPECT_EQ(is_same, first.name == second.name) << first.name << " and " << second.name;
    compared += is_same ? 1 : 0;
  }
  EXPECT_GT(compared, 0);
}

TEST(FurnitureInstances, NoTwoKindsStandAlike) {
  const Problem shelf = instances_of(find_study("furniture_shelf"), 2)(kSeed, 0);
  const Problem tall = instances_of(find_study("furniture_tall_shelf"), 2)(kSeed, 0);
  EXPECT_FALSE(shelf.scene.objects.at(1).T_task_object.linear().isApprox(
      tall.scene.objects.at(1).T_task_object.linear()));
  EXPECT_NE(shelf.seed, tall.seed);
}

TEST(FurnitureInstances, ARobotOutOfReachOrWithoutAHomeIsSaid) {
  const Study& study = find_study("furniture_box");
  StudyRobot placed = study.robots.at(2);
  placed.T_task_base.translation().x() = -4;
  EXPECT_THROW(study.make_instances(robot_named(placed.model), placed)(kSeed, 0), Failure);
  placed.start.resize(0);
  EXPECT_THROW(study.make_instances(robot_named(placed.model), placed), Failure);
}

TEST(Families, FurnitureStandsForItsKindsAndAStudyForItself) {
  EXPECT_EQ(families(), (std::vector<std::string>{"furniture", "dear"}));
  std::vector<std::string> names;
  for (const Study* const study : find_studies("furniture"))
    names.push_back(study->name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"furniture_shelf", "furniture_tall_shelf", "furniture_box",
                                      "furniture_cage", "furniture_table"}));
  ASSERT_EQ(find_studies("furniture_box").size(), 1U);
  EXPECT_EQ(find_studies("furniture_box").front()->name, "furniture_box");
  EXPECT_THROW(find_studies(""), Failure);
}

TEST(FurnitureStudies, AreAsTheProtocolSays) {
  for (const Study* const study : find_studies("furniture")) {
    EXPECT_EQ(study->learning_instances, 50U);
    EXPECT_EQ(study->test_instances, 50U);
    EXPECT_EQ(study->settings.max_checks, 200'000U);
  }
  std::set<std::uint64_t> seeds;
  for (const InstanceSet set :
       {InstanceSet::Calibration, InstanceSet::Tuning, InstanceSet::Test, InstanceSet::Order})
    seeds.insert(seed_of(set, 0));
  for (std::size_t robot = 0; robot < 5; ++robot)
    seeds.insert(seed_of(InstanceSet::Learning, robot));
  EXPECT_EQ(seeds.size(), 9U);
}

}  // namespace
}  // namespace kinship::experiments::furniture_scene_test
