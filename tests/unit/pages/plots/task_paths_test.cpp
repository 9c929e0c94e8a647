#include "pages/plots/task_paths.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/pages/plots/known_paths.hpp"

namespace kinship::plots::task_paths_test {
namespace {

using test::KnownPaths;
using test::turn_of_panda;
using test::turn_of_ur10e;

TaskPaths figure_of(KnownPaths& known) {
  TaskSummary task;
  task.task = "shelf";
  task.paths = known.attempts.size();
  return task_paths(task, known.look_up());
}

RecordedScene ball(const std::string& name) {
  return {{{name, SphereShape{0.1}, Eigen::Isometry3d::Identity()}}, {}, {}};
}

TEST(Simplified, OfALineAreItsEnds) {
  Eigen::Matrix3Xd way(3, 9);
  way << Eigen::RowVectorXd::LinSpaced(9, 0, 2), Eigen::MatrixXd::Constant(2, 9, 0.5);
  EXPECT_EQ(simplified(way, 0.001), (std::vector<Eigen::Index>{0, 8}));
  EXPECT_EQ(simplified(way.leftCols(1), 0.001), (std::vector<Eigen::Index>{0}));
}

TEST(Simplified, OfAnArcAreAsManyAsTheToleranceNeeds) {
  constexpr Eigen::Index kPoints = 200;
  Eigen::Matrix3Xd way(3, kPoints);
  const Eigen::ArrayXd angle = Eigen::ArrayXd::LinSpaced(kPoints, 0, 3);
  way << angle.cos().matrix().transpose(), angle.sin().matrix().transpose(),
      Eigen::RowVectorXd::Zero(kPoints);
  const std::vector<Eigen::Index> kept = simplified(way, 0.002);
  // A chord of angle a is 1 - cos(a / 2) away from its arc: 0.126 rad for 2 mm.
  EXPECT_GE(kept.size(), 25U);
  EXPECT_LE(kept.size(), 50U);
  for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
    const Eigen::Vector3d from = way.col(kept[i]), along = way.col(kept[i + 1]) - from;
    for (Eigen::Index between = kept[i] + 1; between < kept[i + 1]; ++between)
      EXPECT_LE((way.col(between) - from).cross(along).norm() / along.norm(), 0.002);
  }
}

TEST(TaskPaths, AreTheWaysOfHandsFromStartToGoal) {
  KnownPaths known;
  const Eigen::Isometry3d placement(Eigen::Translation3d(1, 2, 3));
  known.add("ur10e", turn_of_ur10e(1)).T_task_base = placement;
  const TaskPaths figure = figure_of(known);
  ASSERT_EQ(figure.paths.size(), 1U);
  const kinematics::Chain chain = kinship::test::model_chain("ur10e");
  const Eigen::Matrix3Xd& hand = figure.paths[0].hand;
  const auto hand_at = [&](Eigen::Index waypoint) -> Eigen::Vector3d {
    return placement *
           kinematics::T_base_transfer(chain, turn_of_ur10e(1).col(waypoint)).translation();
  };
  EXPECT_TRUE(hand.col(0).isApprox(hand_at(0), 1e-9));
  EXPECT_TRUE(hand.rightCols<1>().isApprox(hand_at(1), 1e-9));
  EXPECT_GT(hand.cols(), 3) << "an arc";
  EXPECT_LT(hand.cols(), 30);
  const Eigen::Matrix3Xd& arm = figure.robots[0].arm;
  ASSERT_EQ(arm.cols(), 8) << "base, six joints, hand";
  EXPECT_TRUE(arm.col(0).isApprox(placement.translation()));
  EXPECT_TRUE(arm.rightCols<1>().isApprox(hand_at(0), 1e-9));
}

TEST(TaskPaths, StandInTheOrderOfArrivalWithRobotsByLabel) {
  KnownPaths known;
  known.add("ur10e", turn_of_ur10e(1));
  known.add("panda", turn_of_panda(1));
  known.add("ur10e", turn_of_ur10e(0.5));
  const TaskPaths figure = figure_of(known);
  ASSERT_EQ(figure.robots.size(), 2U);
  EXPECT_EQ(figure.robots[0].label, "panda");
  EXPECT_EQ(figure.robots[1].label, "ur10e");
  std::vector<std::size_t> robots;
  std::vector<std::int64_t> times;
  for (const TaskPath& path : figure.paths) {
    robots.push_back(path.robot);
    times.push_back(path.summary.received_ms);
  }
  EXPECT_EQ(robots, (std::vector<std::size_t>{1, 0, 1}));
  EXPECT_EQ(times, (std::vector<std::int64_t>{1000, 1001, 1002}));
}

TEST(TaskPaths, AreTheNewestOfMany) {
  KnownPaths known;
  for (std::size_t i = 0; i < kMaxTaskPaths + 3; ++i)
    known.add("ur10e", turn_of_ur10e(0.01));
  const TaskPaths figure = figure_of(known);
  EXPECT_EQ(figure.in_use, kMaxTaskPaths + 3);
  ASSERT_EQ(figure.paths.size(), kMaxTaskPaths);
  EXPECT_EQ(figure.paths.front().summary.received_ms, 1003);
  for (std::size_t i = 0; i < 3; ++i)
    known.newest_first[i].retired_ms = 5;
  EXPECT_EQ(figure_of(known).paths.size(), kMaxTaskPaths) << "retired ones take no place";
}

TEST(TaskPaths, WithoutRetiredOnesAndThoseThatCannotBeRead) {
  KnownPaths known;
  for (int i = 0; i < 4; ++i)
    known.add("ur10e", turn_of_ur10e(1));
  known.add("panda", turn_of_panda(1));
  known.newest_first[1].retired_ms = 5;
  known.attempts.erase(known.newest_first[2].report_uuid);
  known.attempts.at(known.newest_first[3].report_uuid).path.reset();
  known.descriptions.erase(known.newest_first[0].robot);
  const TaskPaths figure = figure_of(known);
  ASSERT_EQ(figure.paths.size(), 1U);
  EXPECT_EQ(figure.paths[0].summary.received_ms, 1000);
  EXPECT_EQ(figure.left_out, 3U);
}

TEST(TaskPaths, EqualScenesAreOneAndThoseOfMostPathsComeFirst) {
  KnownPaths known;
  for (const char* const name : {"rare", "common", "common", ""})
    if (Attempt& attempt = known.add("ur10e", turn_of_ur10e(1)); *name != '\0')
      attempt.scene = ball(name);
  const TaskPaths figure = figure_of(known);
  ASSERT_EQ(figure.scenes.size(), 2U);
  EXPECT_EQ(figure.scenes[0].objects[0].name, "common");
  EXPECT_EQ(figure.scenes[0].paths, 2U);
  EXPECT_EQ(figure.scenes_known, 2U);
  EXPECT_EQ(figure.paths[0].scene, 1U);
  EXPECT_EQ(figure.paths[1].scene, 0U);
  EXPECT_FALSE(figure.paths[3].scene);
}

TEST(TaskPaths, OfManyScenesSomeAreDrawn) {
  KnownPaths known;
  for (std::size_t i = 0; i < kMaxTaskScenes + 2; ++i)
    known.add("ur10e", turn_of_ur10e(0.1)).scene = ball(std::to_string(i));
  const TaskPaths figure = figure_of(known);
  EXPECT_EQ(figure.scenes.size(), kMaxTaskScenes);
  EXPECT_EQ(figure.scenes_known, kMaxTaskScenes + 2);
  std::ptrdiff_t without = 0;
  for (const TaskPath& path : figure.paths)
    without += path.scene ? 0 : 1;
  EXPECT_EQ(without, 2);
}

TEST(TaskPaths, ObjectsAreBoundedToo) {
  KnownPaths known;
  RecordedScene many = ball("first");
  many.objects.resize(kMaxTaskObjects / 2 + 1, many.objects[0]);
  known.add("ur10e", turn_of_ur10e(0.1)).scene = many;
  many.objects[0].name = "second";
  known.add("ur10e", turn_of_ur10e(0.1)).scene = many;
  EXPECT_EQ(figure_of(known).scenes.size(), 1U);
}

TEST(TaskPaths, TheirJsonHasWaysInMillimetres) {
  KnownPaths known;
  Attempt& attempt = known.add("ur10e", turn_of_ur10e(1));
  attempt.scene = ball("ball");
  known.newest_first[0].record.collision_checks = 17;
  known.newest_first[0].record.sampling_mode = SamplingMode::Control;
  const TaskPaths figure = figure_of(known);
  const auto json = nlohmann::json::parse(to_json(figure));
  EXPECT_EQ(json["in_use"], 1);
  EXPECT_EQ(json["robots"][0]["label"], "ur10e");
  EXPECT_EQ(json["robots"][0]["arm"].size(), 24U);
  const auto& path = json["paths"][0];
  EXPECT_EQ(path["uuid"], attempt.report_uuid.text());
  EXPECT_EQ(path["checks"], 17);
  EXPECT_EQ(path["mode"], "control");
  EXPECT_EQ(path["scene"], 0);
  ASSERT_EQ(path["hand"].size(), static_cast<std::size_t>(figure.paths[0].hand.size()));
  EXPECT_NEAR(path["hand"][0].get<double>(), 1000 * figure.paths[0].hand(0, 0), 0.51);
  EXPECT_EQ(json["scenes"][0]["objects"][0]["name"], "ball");
  EXPECT_EQ(json["scenes"][0]["paths"], 1);
}

}  // namespace
}  // namespace kinship::plots::task_paths_test
