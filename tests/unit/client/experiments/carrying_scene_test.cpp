#include "client/experiments/studies/carrying_scene.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::carrying_scene_test {
namespace {

constexpr std::uint64_t kSeed = 77;  // of no set of instances
constexpr std::uint32_t kInstances = 2;

models::LoadedRobot robot_named(const std::string& name) {
  const std::string folder = test::source_dir() + "/robots/models/" + name;
  return models::load_robot({.source = folder}).value_or_throw();
}

DrawInstance instances_of(const Study& study, std::size_t robot) {
  const StudyRobot& placed = study.robots.at(robot);
  return study.make_instances(robot_named(placed.model), placed);
}

Eigen::Isometry3d T_task_transfer(const models::LoadedRobot& robot, const Problem& problem,
                                  const Eigen::VectorXd& q) {
  return *problem.T_task_base * kinematics::T_base_transfer(robot.chain, q);
}

const SceneObject* find_object(const Problem& problem, const std::string& name) {
  for (const SceneObject& object : problem.scene.objects)
    if (object.name == name)
      return &object;
  return nullptr;
}

/// Study and robot.
class CobotStudies : public testing::TestWithParam<std::tuple<const char*, std::size_t>> {
 protected:
  const Study& study() const { return find_study(std::get<0>(GetParam())); }
  const StudyRobot& placed() const { return study().robots.at(std::get<1>(GetParam())); }
};

TEST_P(CobotStudies, StartAndGoalsAreFreeUprightApartAndWithinThePlanningBounds) {
  const models::LoadedRobot robot = robot_named(placed().model);
  const DrawInstance draw = study().make_instances(robot, placed());
  bool turned = false;  // the hand
  for (std::uint32_t index = 0; index < kInstances; ++index) {
    const Problem problem = draw(kSeed, index);
    const Eigen::MatrixXd& goals = problem.goal_configurations;
    ASSERT_GE(goals.cols(), 1) << problem.name;
    collision::CollisionWorld world(
        robot.chain, robot.shapes,
        {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
    const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot.chain, problem.start);
    const planning::RegionConstraint constraint(robot.chain, problem.constraint.value(),
                                                *problem.T_task_base, bounds);
    Eigen::MatrixXd ends(robot.chain.dof(), 1 + goals.cols());
    ends << problem.start, goals;
    for (const auto& q : ends.colwise()) {
      EXPECT_FALSE(world.collides(q)) << problem.name;
      EXPECT_TRUE(constraint.holds(q)) << problem.name << constraint.excess(q).transpose();
      EXPECT_TRUE((q.array() >= bounds.row(0).transpose().array()).all() &&
                  (q.array() <= bounds.row(1).transpose().array()).all())
          << problem.name;
    }
    const Eigen::Isometry3d T_task_first = T_task_transfer(robot, problem, goals.col(0));
    for (Eigen::Index i = 1; i < goals.cols(); ++i) {
      const Eigen::Isometry3d T_task_goal = T_task_transfer(robot, problem, goals.col(i));
      EXPECT_TRUE(T_task_goal.translation().isApprox(T_task_first.translation(), 1e-5));
      turned = turned || (T_task_goal.linear().col(0) + T_task_first.linear().col(0)).norm() < 1e-4;
      for (Eigen::Index j = 0; j < i; ++j)
        EXPECT_GT((goals.col(i) - goals.col(j)).norm(), 0.1) << i << " and " << j;
    }
  }
  EXPECT_TRUE(turned) << "the hand has the same way at every goal";
}

std::string case_name(const testing::TestParamInfo<CobotStudies::ParamType>& test) {
  const auto& [name, robot] = test.param;
  return std::string(name) + "_" + find_study(name).robots.at(robot).model;
}

INSTANTIATE_TEST_SUITE_P(Every, CobotStudies,
                         testing::Combine(testing::Values("cobots", "open_table_cobots"),
                                          testing::Range<std::size_t>(0, 5)),
                         case_name);

TEST(CarryingScene, EqualSeedsGiveEqualProblemsAndInstancesDiffer) {
  const Study& study = find_study("cobots");
  const DrawInstance draw = instances_of(study, 2), again = instances_of(study, 2);
  EXPECT_EQ(json::to_json(draw(kSeed, 1)), json::to_json(again(kSeed, 1)));
  const Problem first = draw(kSeed, 1), second = draw(kSeed, 2);
  EXPECT_FALSE(first.start.isApprox(second.start));
  EXPECT_FALSE(
      first.scene.objects.back().T_task_object.isApprox(second.scene.objects.back().T_task_object));
}

TEST(CarryingScene, IsTheSameForEveryRobotUnlessDrawnAgain) {
  const Study& study = find_study("cobots");
  const DrawInstance of_one = instances_of(study, 3), of_another = instances_of(study, 2);
  int compared = 0;
  for (std::uint32_t index = 0; index < kInstances; ++index) {
    const Problem first = of_one(kSeed, index), second = of_another(kSeed, index);
    if (first.name != second.name)
      continue;
    ++compared;
    for (const SceneObject& object : first.scene.objects) {
      const SceneObject* const same = find_object(second, object.name);
      ASSERT_NE(same, nullptr) << object.name;
      EXPECT_TRUE(object.T_task_object.isApprox(same->T_task_object)) << object.name;
    }
  }
  EXPECT_GT(compared, 0);
}

TEST(CarryingScene, EitherPlaceOfTheBinIsTakenAndTheContainerGoesToTheOther) {
  const Study& study = find_study("cobots");
  const models::LoadedRobot robot = robot_named(study.robots[2].model);
  const DrawInstance draw = study.make_instances(robot, study.robots[2]);
  int behind = 0, before = 0;
  constexpr std::uint32_t kMany = 12;
  for (std::uint32_t index = 0; index < kMany; ++index) {
    const Problem problem = draw(kSeed, index);
    const Eigen::Isometry3d T_bin_task =
        find_object(problem, "bin_left")->T_task_object.inverse(Eigen::Isometry);
    const auto along_bin = [&](const Eigen::Vector3d& p_task) { return (T_bin_task * p_task).x(); };
    const double taken =
        along_bin(find_object(problem, "other_container")->T_task_object.translation());
    const double goal = along_bin(
        T_task_transfer(robot, problem, problem.goal_configurations.col(0)).translation());
    EXPECT_NEAR(goal, -taken, 1e-6) << problem.name;
    ++(taken > 0 ? behind : before);
  }
  EXPECT_GT(behind, 0);
  EXPECT_GT(before, 0);
}

TEST(CarryingScene, TheHandMayTiltAsFarAsTheTaskSaysAndTurnAboutTheVertical) {
  const models::LoadedRobot robot = robot_named("panda");
  constexpr double kTilt_rad = 0.15;
  const Study& study = find_study("cobots");
  const Problem problem = study.make_instances(robot, study.robots.at(3))(kSeed, 0);
  const planning::RegionConstraint constraint(
      robot.chain, planning::upright_region(kTilt_rad), *problem.T_task_base,
      planning::planning_bounds(robot.chain, problem.start));
  Eigen::VectorXd q = problem.start;
  q[6] += 0.3;  // the last axis is vertical
  EXPECT_TRUE(constraint.holds(q));
  Eigen::VectorXd tilted = problem.start;
  tilted[5] += 0.9 * kTilt_rad;  // a horizontal axis
  EXPECT_TRUE(constraint.holds(tilted));
  tilted[5] += 0.6 * kTilt_rad;
  EXPECT_FALSE(constraint.holds(tilted));
}

TEST(CobotStudy, IsAsTheProtocolSays) {
  const Study& study = find_study("cobots");
  EXPECT_EQ(study.robots.size(), 5U);
  EXPECT_EQ(study.learning_instances, 500U);
  EXPECT_EQ(study.test_instances, 100U);
  EXPECT_EQ(study.settings.resolution, 0.1);
  EXPECT_EQ(study.settings.max_checks, 200'000U);
}

TEST(CobotStudy, ARobotThatCannotReachThePickIsSaid) {
  const Study& study = find_study("cobots");
  StudyRobot far = study.robots.at(3);
  far.T_task_base.translation().x() = -3;
  far.start.resize(0);  // searched, as for a study that is not frozen
  try {
    study.make_instances(robot_named(far.model), far);
    FAIL() << "an arm 3 m away has no start";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
    EXPECT_NE(std::string(failure.what()).find("panda"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::experiments::carrying_scene_test
