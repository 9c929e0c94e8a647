#include "client/experiments/studies/dear_scene.hpp"

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
#include "robots/planning/region_constraint.hpp"
#include "tests/support/places.hpp"

namespace kinship::experiments::dear_scene_test {
namespace {

constexpr std::uint64_t kSeed = 77;  // of no set of instances

constexpr DearKind kDearKinds[] = {DearKind::LiftCage, DearKind::LiftShelf, DearKind::Window,
                                   DearKind::Gun,      DearKind::Bin,       DearKind::Upright,
                                   DearKind::Cloud,    DearKind::Beside};

models::LoadedRobot loaded(const StudyRobot& placed) {
  return models::load_robot({.source = test::source_dir() + "/robots/models/" + placed.model})
      .value_or_throw();
}

class EveryDearKind : public testing::TestWithParam<DearKind> {};

TEST_P(EveryDearKind, HasOtherMeasuresEachTime) {
  std::mt19937_64 generator(kSeed);
  std::set<double> measures, goals;
  for (int i = 0; i < 20; ++i) {
    const DearScene instance = draw_dear_scene(GetParam(), generator);
    goals.insert(instance.T_task_goal.translation().x());
    double size = 0;
    for (const SceneObject& object : instance.scene.objects)
      if (const auto* const box = std::get_if<BoxShape>(&object.shape)) {
        EXPECT_GT(box->size.minCoeff(), 0) << object.name;
        size += box->size.sum();
      }
    for (const SceneCloud& cloud : instance.scene.clouds)
      size += static_cast<double>(cloud.cloud.voxels->cols());
    measures.insert(size);
  }
  EXPECT_EQ(measures.size(), 20U);
  EXPECT_EQ(goals.size(), 20U);
}

/// Start and goals are free and upright where they must be, and each line between them collides.
void expect_dear(const Study& study, const models::LoadedRobot& robot, const Problem& problem) {
  SCOPED_TRACE(problem.name + " of " + robot.description.label);
  collision::CollisionWorld world(
      robot.chain, robot.shapes,
      {*problem.T_task_base, problem.scene, problem.attached, problem.allowed_collisions});
  EXPECT_FALSE(world.collides(problem.start));
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot.chain, problem.start);
  planning::GoalOptions options;
  options.max_configurations = study.settings.max_goals;
  options.seed = problem.seed;
  const Eigen::MatrixXd goals =
      planning::goal_configurations(
          robot.chain, problem.T_task_base->inverse() * *problem.T_task_goal, bounds,
          [&](const Eigen::VectorXd& q) { return !world.collides(q); }, options)
          .configurations;
  EXPECT_GT(goals.cols(), 0);
  for (const auto& goal : goals.colwise()) {
    const int steps = static_cast<int>(std::ceil((goal - problem.start).norm() / 0.05));
    int colliding = 0;
    for (int i = 0; i <= steps; ++i)
      colliding += world.collides(problem.start + (goal - problem.start) * i / steps);
    EXPECT_GT(colliding, 0) << goal.transpose();
  }
  if (!problem.constraint)
    return;
  const planning::RegionConstraint region(robot.chain, *problem.constraint, *problem.T_task_base,
                                          bounds);
  EXPECT_TRUE(region.holds(problem.start));
  for (const auto& goal : goals.colwise())
    EXPECT_TRUE(region.holds(goal));
}

TEST_P(EveryDearKind, BeginsFreeHasGoalsAndNoStraightLineToThem) {
  constexpr std::uint32_t kInstances = 5;
  const Study& study = find_study(study_name(GetParam()));
  ASSERT_GE(study.robots.size(), 2U);
  for (const StudyRobot& placed : study.robots) {
    const models::LoadedRobot robot = loaded(placed);
    const DrawInstance draw = study.make_instances(robot, placed);
    for (std::uint32_t index = 0; index < kInstances; ++index)
      expect_dear(study, robot, draw(kSeed, index));
  }
}

INSTANTIATE_TEST_SUITE_P(Dear, EveryDearKind, testing::ValuesIn(kDearKinds),
                         [](const auto& test) { return std::string(study_name(test.param)); });

TEST(DearInstances, EqualSeedsGiveEqualProblemsAndKindsDiffer) {
  const Study& study = find_study("dear_gun");
  const StudyRobot& placed = study.robots.front();
  const DrawInstance draw = study.make_instances(loaded(placed), placed);
  EXPECT_EQ(json::to_json(draw(kSeed, 1)),
            json::to_json(study.make_instances(loaded(placed), placed)(kSeed, 1)));
  EXPECT_FALSE(draw(kSeed, 1).T_task_goal->isApprox(*draw(kSeed, 2).T_task_goal));
}

TEST(DearInstances, ARobotOutOfReachOrWithoutAHomeIsSaid) {
  const Study& study = find_study("dear_gun");
  StudyRobot placed = study.robots.front();
  placed.T_task_base.translation().x() = -4;
  EXPECT_THROW(study.make_instances(loaded(placed), placed)(kSeed, 0), Failure);
  placed.start.resize(0);
  EXPECT_THROW(study.make_instances(loaded(placed), placed), Failure);
}

TEST(DearCloud, HasEveryCubeThatABoardIsIn) {
  const std::vector<SceneObject> board = {
      {"board", BoxShape{{0.4, 0.3, 0.02}}, Eigen::Isometry3d(Eigen::Translation3d(0.2, 0, 0.05))}};
  const Eigen::Matrix3Xd voxels = voxels_in(board, 0.02);
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p(0.2 + 0.4 * part(generator), 0.3 * part(generator),
                            0.05 + 0.02 * part(generator));
    EXPECT_LE((voxels.colwise() - p).colwise().lpNorm<Eigen::Infinity>().minCoeff(), 0.01 + 1e-9);
  }
  // Cubes that a face only touches are in as well, none further away.
  EXPECT_LE(voxels.row(2).maxCoeff(), 0.07 + 1e-9);
  EXPECT_GE(voxels.row(2).minCoeff(), 0.03 - 1e-9);
}

TEST(DearStudies, AreOneFamilyWithArmsOnLiftsAndOneConstraint) {
  int constrained = 0;
  for (const Study* const study : find_studies("dear")) {
    EXPECT_EQ(study->family, "dear");
    EXPECT_TRUE(study->name.starts_with("dear_"));
    EXPECT_EQ(study->learning_instances, 50U);
    EXPECT_EQ(study->test_instances, 50U);
    constrained += study->is_constrained ? 1 : 0;
    for (const StudyRobot& placed : study->robots) {
      const bool has_lift = placed.model.ends_with("_lift");
      EXPECT_EQ(has_lift, study->name.starts_with("dear_lift")) << placed.model;
      EXPECT_EQ(loaded(placed).chain.dof() == 8, has_lift) << placed.model;
    }
  }
  EXPECT_EQ(find_studies("dear").size(), std::size(kDearKinds));
  EXPECT_EQ(constrained, 1);
}

}  // namespace
}  // namespace kinship::experiments::dear_scene_test
