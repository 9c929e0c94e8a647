#include "client/experiments/station_problems.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/loaded_robot.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::station_problems_test {
namespace {

constexpr std::uint64_t kSeed = 3;
constexpr std::uint32_t kInstances = 6;

models::LoadedRobot robot_named(const std::string& name) {
  const std::string folder = test::source_dir() + "/robots/models/" + name;
  return models::load_robot({.source = folder}).value_or_throw();
}

Problem drawn(Station station, const models::LoadedRobot& robot, std::uint32_t index) {
  return draw_station_problem(station, robot, placement_at(station, robot.description.label),
                              {kSeed, index, 0});
}

collision::CollisionWorld world_of(const models::LoadedRobot& robot, const Problem& problem) {
  return {robot.chain,
          robot.shapes,
          {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions}};
}

using RobotAtStation = std::tuple<Station, const char*>;

class StationProblems : public testing::TestWithParam<RobotAtStation> {
 protected:
  Station station() const { return std::get<0>(GetParam()); }
  models::LoadedRobot robot() const { return robot_named(std::get<1>(GetParam())); }
};

TEST_P(StationProblems, StartIsFreeAndHoldsTheThingAtThePick) {
  const models::LoadedRobot robot = this->robot();
  for (std::uint32_t index = 0; index < kInstances; ++index) {
    const Problem problem = drawn(station(), robot, index);
    EXPECT_TRUE(robot.chain.within_limits(problem.start));
    EXPECT_FALSE(world_of(robot, problem).collides(problem.start)) << problem.name;
    const Eigen::Isometry3d T_task_transfer =
        *problem.T_task_base * kinematics::T_base_transfer(robot.chain, problem.start);
    EXPECT_NEAR(T_task_transfer.linear()(2, 2), -1, 1e-6);  // the gripper looks down
  }
}

TEST_P(StationProblems, TheGoalHasAFreeConfiguration) {
  const models::LoadedRobot robot = this->robot();
  for (std::uint32_t index = 0; index < kInstances; ++index) {
    const Problem problem = drawn(station(), robot, index);
    collision::CollisionWorld world = world_of(robot, problem);
    const Eigen::Isometry3d T_base_tip = problem.T_task_base->inverse() * *problem.T_task_goal *
                                         robot.chain.T_tip_transfer().inverse();
    inverse::InverseOptions options;
    options.max_solutions = 20;
    const Eigen::MatrixXd goals = inverse::inverse(robot.chain, T_base_tip, options).configurations;
    int free = 0;
    for (const auto& q : goals.colwise())
      if (!world.collides(q))
        ++free;
    EXPECT_GT(free, 0) << problem.name;
  }
}

TEST_P(StationProblems, EqualSeedsGiveEqualProblems) {
  const models::LoadedRobot robot = this->robot();
  const Problem first = drawn(station(), robot, 1);
  const Problem second = drawn(station(), robot, 1);
  EXPECT_EQ(first.start, second.start);
  EXPECT_EQ(first.seed, second.seed);
  EXPECT_EQ(first.T_task_goal->matrix(), second.T_task_goal->matrix());
  EXPECT_NE(first.start, drawn(station(), robot, 2).start);
}

INSTANTIATE_TEST_SUITE_P(EveryRobot, StationProblems,
                         testing::Combine(testing::Values(Station::Machine, Station::Shelf),
                                          testing::Values("panda", "iiwa14", "ur10e")),
                         [](const auto& each) {
                           return std::string(std::get<1>(each.param)) + "_at_" +
                                  std::string(to_text(std::get<0>(each.param)));
                         });

TEST(StationProblemsOfSeveralRobots, EqualNamesAreEqualScenes) {
  const models::LoadedRobot panda = robot_named("panda");
  const models::LoadedRobot ur10e = robot_named("ur10e");
  int compared = 0;
  for (std::uint32_t index = 0; index < kInstances; ++index) {
    const Problem one = drawn(Station::Machine, panda, index);
    const Problem other = drawn(Station::Machine, ur10e, index);
    if (one.name != other.name)
      continue;  // drawn again for one of them
    ++compared;
    EXPECT_EQ(one.T_task_goal->matrix(), other.T_task_goal->matrix());
    EXPECT_EQ(one.seed, other.seed);
    ASSERT_EQ(one.scene.objects.size(), other.scene.objects.size());
    for (std::size_t i = 0; i < one.scene.objects.size(); ++i)
      EXPECT_EQ(one.scene.objects[i].T_task_object.matrix(),
                other.scene.objects[i].T_task_object.matrix());
  }
  EXPECT_GT(compared, kInstances / 2);
}

TEST(StationProblemsOfSeveralRobots, APlacementOutOfReachIsAFailureThatSaysSo) {
  const models::LoadedRobot robot = robot_named("panda");
  Eigen::Isometry3d far_away = Eigen::Isometry3d::Identity();
  far_away.translation().x() = -5;
  try {
    draw_station_problem(Station::Machine, robot, far_away, {kSeed, 0, 0});
    FAIL() << "drew a problem out of reach";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
    EXPECT_NE(std::string(failure.what()).find("placement"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::experiments::station_problems_test
