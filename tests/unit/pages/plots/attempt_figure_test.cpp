#include "pages/plots/attempt_figure.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "pages/plots/same_query.hpp"
#include "proto/types/failure.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/robots.hpp"

namespace kinship::plots::attempt_figure_test {
namespace {

using nlohmann::json;

const Eigen::Isometry3d kPlacement(Eigen::Translation3d(1, 2, 3));

/// The UR10e turns its first joint by 1 rad in two steps, the first of a quarter of it.
Attempt turning() {
  Eigen::MatrixXd waypoints(6, 3);
  waypoints.colwise() = Eigen::VectorXd{{0, -1.2, 1.8, -2.2, -1.57, 0}};
  waypoints.row(0) << 0, 0.25, 1;
  Attempt attempt;
  attempt.robot = kinship::test::model_chain("ur10e").digest();
  attempt.task = "turn";
  attempt.T_task_base = kPlacement;
  attempt.record.outcome = Outcome::Solved;
  attempt.path = Path(waypoints);
  return attempt;
}

AttemptFigure figure_of(const Attempt& attempt) {
  return attempt_figure(attempt, kinship::test::model_description("ur10e"));
}

Eigen::Vector3d hand_at(double q0) {
  return kPlacement * kinematics::T_base_transfer(kinship::test::model_chain("ur10e"),
                                                  Eigen::VectorXd{{q0, -1.2, 1.8, -2.2, -1.57, 0}})
                          .translation();
}

TEST(AttemptFigure, PlacesAreAtEqualPartsOfThePathsLength) {
  const AttemptFigure figure = figure_of(turning());
  ASSERT_TRUE(figure.path);
  const PathPlaces& path = *figure.path;
  EXPECT_EQ(path.waypoints_at, (std::vector<double>{0, 0.25, 1}));
  EXPECT_DOUBLE_EQ(path.length, 1);
  ASSERT_EQ(path.hand.cols(), kPlacesOfPath);
  for (const Eigen::Index i :
       {Eigen::Index{0}, Eigen::Index{20}, Eigen::Index{110}, kPlacesOfPath - 1})
    EXPECT_TRUE(path.hand.col(i).isApprox(hand_at(static_cast<double>(i) / 200), 1e-9)) << i;
  const double radius = (hand_at(0) - kPlacement.translation()).head<2>().norm();
  EXPECT_NEAR(path.hand_length_m, radius, 1e-4) << "an arc of 1 rad";
}

TEST(AttemptFigure, AFailedOneShowsWhatWasInTheWayAndTheHandsOfItsTrees) {
  Attempt attempt = turning();
  const Eigen::MatrixXd waypoints = attempt.path->waypoints();
  attempt.path.reset();
  attempt.record.outcome = Outcome::Failed;
  SearchRecord& search = attempt.search.emplace();
  search.start = waypoints.col(0);
  search.goals = waypoints.rightCols<1>();
  search.blockers = {{"hand", "wall", 7}};
  search.goal_contacts = {{0, "hand", "table"}};
  search.trees.push_back({waypoints.cast<float>(), {-1, 0, 1}});
  search.reason = "no way";
  const json drawn = json::parse(to_json(figure_of(attempt)));
  EXPECT_TRUE(drawn["path"].is_null());
  EXPECT_FALSE(drawn["attempt"].contains("search"));
  const json& shown = drawn["search"];
  EXPECT_EQ(shown["blockers"],
            json::parse(R"([{"first": "hand", "second": "table", "goals": 1, "count": 0},
                            {"first": "hand", "second": "wall", "goals": 0, "count": 7}])"))
      << "what blocks goals first";
  EXPECT_EQ(shown["goal_contacts"][0]["second"], "table");
  EXPECT_EQ(shown["start"].size(), 6U);
  EXPECT_EQ(shown["goals"].size(), 1U);
  EXPECT_TRUE(shown["last_free"].empty());
  EXPECT_EQ(shown["reason"], "no way");
  ASSERT_EQ(shown["trees"].size(), 1U);
  EXPECT_EQ(shown["trees"][0]["parents"], json({-1, 0, 1}));
  const auto hand = shown["trees"][0]["hand"].get<std::vector<double>>();
  ASSERT_EQ(hand.size(), 9U);
  EXPECT_TRUE(Eigen::Map<const Eigen::Vector3d>(&hand[6]).isApprox(1000 * hand_at(1), 1e-3));
}

/// A ball at the height of the hand where it is halfway.
RecordedScene ball_at_half(double gap_m) {
  const Eigen::Vector3d out =
      (hand_at(0.5) - kPlacement.translation()).cwiseProduct(Eigen::Vector3d(1, 1, 0));
  return {
      {{"ball", SphereShape{0.1},
        Eigen::Isometry3d(Eigen::Translation3d(hand_at(0.5) + (0.1 + gap_m) * out.normalized()))}},
      {},
      {}};
}

TEST(AttemptFigure, TheNearestObstacleIsNearestWhereItStands) {
  Attempt attempt = turning();
  attempt.scene = ball_at_half(0.3);
  const PathPlaces path = *figure_of(attempt).path;
  ASSERT_TRUE(path.nearest_obstacle);
  EXPECT_NEAR(static_cast<double>(*path.nearest_obstacle), 100, 25);
  const auto& least = path.nearest[*path.nearest_obstacle].obstacle;
  EXPECT_EQ(least->second, "ball");
  EXPECT_GT(least->distance_m, 0.1);
  EXPECT_LT(least->distance_m, 0.35);
  EXPECT_GT(path.nearest.front().obstacle->distance_m, least->distance_m);
}

TEST(AttemptFigure, WhatStaysAtOneDistanceIsToldOnce) {
  Attempt attempt = turning();
  attempt.scene = ball_at_half(0.6);
  attempt.scene->objects.push_back(
      {"table", BoxShape{{2, 2, 0.1}},
       kPlacement * Eigen::Isometry3d(Eigen::Translation3d(0, 0, -0.1))});
  const AttemptFigure figure = figure_of(attempt);
  ASSERT_FALSE(figure.path->steady.empty());
  EXPECT_EQ(figure.path->steady[0].second, "table");
  for (const auto& nearest : figure.path->nearest)
    EXPECT_NE(std::pair(nearest.obstacle->first, nearest.obstacle->second),
              std::pair(figure.path->steady[0].first, figure.path->steady[0].second));
}

TEST(AttemptFigure, ItsJsonHasThePathTheSceneAndWhatItHolds) {
  Attempt attempt = turning();
  attempt.scene = ball_at_half(0.3);
  attempt.scene->held.push_back({"part", SphereShape{0.02}});
  const json data = json::parse(to_json(figure_of(attempt)));
  EXPECT_EQ(data["scene"].size(), 1U);
  EXPECT_EQ(data["held"][0]["name"], "part");
  EXPECT_EQ(data["path"]["waypoints"].size(), 3U);
  EXPECT_EQ(data["path"]["waypoints"][1][0], 0.25);
  EXPECT_EQ(data["path"]["hand"].size(), 3 * kPlacesOfPath);
  EXPECT_EQ(data["path"]["obstacle"]["distance_m"].size(), kPlacesOfPath);
  EXPECT_EQ(data["path"]["obstacle"]["pairs"][100][1], "ball");
  EXPECT_EQ(data["attempt"]["waypoints"], nullptr) << "they stand in the path";
  EXPECT_EQ(data["robot"]["joints"].size(), 6U);
}

TEST(AttemptFigure, WithoutPathAndSceneThereIsTheRobot) {
  Attempt attempt = turning();
  attempt.path.reset();
  attempt.record.outcome = Outcome::Timeout;
  const json data = json::parse(to_json(figure_of(attempt)));
  EXPECT_EQ(data["path"], nullptr);
  EXPECT_EQ(data["scene"], nullptr);
  EXPECT_EQ(data["robot"]["label"], "ur10e");
}

TEST(AttemptFigure, AnotherRobotIsRefused) {
  EXPECT_THROW(attempt_figure(turning(), kinship::test::model_description("panda")), Failure);
}

TEST(AttemptFigure, TheSameQueryIsThatOfOneStartAndOneGoal) {
  const AttemptFigure figure = figure_of(turning());
  Attempt other = turning();
  other.record.sampling_mode = SamplingMode::Guided;
  Eigen::MatrixXd waypoints = other.path->waypoints();
  waypoints(2, 1) += 0.3;  // another way between
  waypoints(5, 2) += 2 * EIGEN_PI;
  other.path = Path(waypoints);
  EXPECT_TRUE(is_same_query(figure, other)) << "the same pose of the hand";
  const auto changed = [&](const auto& change) {
    Attempt attempt = other;
    change(attempt);
    return is_same_query(figure, attempt);
  };
  EXPECT_FALSE(changed([](Attempt& attempt) { attempt.T_task_base.reset(); }));
  EXPECT_FALSE(changed([](Attempt& attempt) { attempt.path.reset(); })) << "nothing is known";
  EXPECT_FALSE(changed([](Attempt& attempt) { attempt.robot = {}; }));
  EXPECT_FALSE(changed([&](Attempt& attempt) {
    Eigen::MatrixXd moved = waypoints;
    moved(1, 0) += 1e-3;
    attempt.path = Path(moved);
  })) << "another start";
  EXPECT_FALSE(changed([&](Attempt& attempt) {
    Eigen::MatrixXd moved = waypoints;
    moved(1, 2) += 0.01;
    attempt.path = Path(moved);
  })) << "another goal";
  EXPECT_FALSE(changed([](Attempt& attempt) {
    attempt.scene.emplace().objects.push_back(
        {"wall", BoxShape{Eigen::Vector3d(1, 1, 1)}, Eigen::Isometry3d::Identity()});
  }));
  EXPECT_TRUE(changed([&](Attempt& attempt) {
    SearchRecord& search = attempt.search.emplace();
    search.start = waypoints.col(0);
    search.goals = waypoints.rightCols<2>();
    attempt.path.reset();
    attempt.record.outcome = Outcome::Timeout;
  })) << "one of the goals of a failed one";
}

}  // namespace
}  // namespace kinship::plots::attempt_figure_test
