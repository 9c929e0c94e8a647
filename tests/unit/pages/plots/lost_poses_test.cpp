#include "pages/plots/lost_poses.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/pages/plots/known_paths.hpp"
#include "tests/unit/pages/plots/plot_values.hpp"

namespace kinship::plots::lost_poses_test {
namespace {

using test::KnownPaths;
using test::turn_of_panda;
using test::turn_of_ur10e;

std::size_t index_of(Loss why) { return static_cast<std::size_t>(why); }

/// Of the UR10e, at the task's frame.
Distribution distribution_of(const std::vector<std::string>& sources) {
  Distribution distribution = test::distribution_for("ur10e");
  distribution.sources.clear();
  for (const std::string& model : sources) {
    Source& source = distribution.sources.emplace_back();
    source.robot = kinship::test::model_chain(model).digest();
    source.label = model;
    source.paths_used = 1;
    source.relation = model == "ur10e" ? Relation::Identical : Relation::Other;
  }
  return distribution;
}

LostPoses lost_of(const Distribution& distribution, KnownPaths& known) {
  return lost_poses(distribution, drawn_robot(kinship::test::model_description("ur10e")),
                    known.look_up());
}

Eigen::Isometry3d shifted(double x_m) { return Eigen::Isometry3d(Eigen::Translation3d(x_m, 0, 0)); }

TEST(LostPoses, OfAFarSourceAllAreOutOfReachWhereItsHandWas) {
  KnownPaths known;
  known.add("panda", turn_of_panda(1)).T_task_base = shifted(5);
  const LostPoses lost = lost_of(distribution_of({"panda"}), known);
  ASSERT_EQ(lost.sources.size(), 1U);
  const SearchedSource& source = lost.sources.at(0);
  EXPECT_EQ(source.paths, 1U);
  EXPECT_EQ(source.poses, 4U) << "0.7 rad in intervals of at most 0.3";
  EXPECT_EQ(source.lost[index_of(Loss::OutOfReach)], 4U);
  const Eigen::Matrix3Xd& places = lost.places[index_of(Loss::OutOfReach)];
  ASSERT_EQ(places.cols(), 4);
  const kinematics::Chain panda = kinship::test::model_chain("panda");
  const Eigen::VectorXd first = turn_of_panda(0.15).col(1);
  EXPECT_TRUE(places.col(0).isApprox(
      shifted(5) * kinematics::T_base_transfer(panda, first).translation(), 1e-9));
}

TEST(LostPoses, NoneOfPosesThatTheRobotTakesItself) {
  KnownPaths known;
  known.add("ur10e", turn_of_ur10e(1)).T_task_base = shifted(0.05);
  const LostPoses lost = lost_of(distribution_of({"ur10e"}), known);
  EXPECT_EQ(lost.sources.at(0).poses, 4U) << "another place: they are searched";
  for (const Eigen::Matrix3Xd& places : lost.places)
    EXPECT_EQ(places.cols(), 0);
}

TEST(LostPoses, WaypointsThatAreTakenOverAreNotSearched) {
  KnownPaths known;
  known.add("ur10e", turn_of_ur10e(1));
  Distribution distribution = distribution_of({"ur10e"});
  const SearchedSource source = lost_of(distribution, known).sources.at(0);
  EXPECT_EQ(source.taken_over, 1U);
  EXPECT_EQ(source.poses, 0U);
  distribution.profile = "default,take_over=0";
  EXPECT_EQ(lost_of(distribution, known).sources.at(0).poses, 4U);
}

TEST(LostPoses, InARecordedWallEveryConfigurationCollides) {
  KnownPaths known;
  Attempt& attempt = known.add("panda", turn_of_panda(1));
  const LostPoses free = lost_of(distribution_of({"panda"}), known);
  EXPECT_EQ(free.sources.at(0).lost[index_of(Loss::Colliding)], 0U);
  const Eigen::Vector3d hand =
      kinematics::T_base_transfer(kinship::test::model_chain("panda"), turn_of_panda(0.5).col(1))
          .translation();
  attempt.scene = RecordedScene{
      {{"wall", BoxShape{{0.2, 2, 0.3}}, Eigen::Isometry3d(Eigen::Translation3d(hand))}}, {}, {}};
  const LostPoses lost = lost_of(distribution_of({"panda"}), known);
  EXPECT_GT(lost.sources.at(0).lost[index_of(Loss::Colliding)], 0U);
  EXPECT_EQ(static_cast<std::uint64_t>(lost.places[index_of(Loss::Colliding)].cols()),
            lost.sources.at(0).lost[index_of(Loss::Colliding)]);
  Distribution careless = distribution_of({"panda"});
  careless.profile = "default,avoid_recorded_scene=0";
  EXPECT_EQ(lost_of(careless, known).sources.at(0).lost[index_of(Loss::Colliding)], 0U);
}

TEST(LostPoses, SourcesShareTheBounds) {
  KnownPaths known;
  for (std::size_t i = 0; i < kMaxSearchedPaths; ++i) {
    known.add("panda", turn_of_panda(1)).T_task_base = shifted(5);
    known.add("sawyer", turn_of_panda(0.2)).T_task_base = shifted(9);
  }
  const LostPoses lost = lost_of(distribution_of({"panda", "sawyer"}), known);
  ASSERT_EQ(lost.sources.size(), 2U);
  for (const SearchedSource& source : lost.sources) {
    EXPECT_EQ(source.paths, kMaxSearchedPaths / 2) << source.label;
    EXPECT_LE(source.poses, kMaxSearchedPoses / 2);
    EXPECT_EQ(std::reduce(source.lost.begin(), source.lost.end()), source.poses);
  }
}

TEST(LostPoses, OnlyOfTheSelectedExperience) {
  KnownPaths known;
  known.add("panda", turn_of_panda(1)).T_task_base = shifted(5);
  known.add("panda", turn_of_panda(1)).T_task_base = shifted(6);
  known.add("panda", turn_of_panda(1)).T_task_base = shifted(7);
  Distribution distribution = distribution_of({"panda"});
  distribution.selection.since_ms = 1001;
  known.newest_first[0].retired_ms = 4;
  const LostPoses lost = lost_of(distribution, known);
  EXPECT_EQ(lost.sources.at(0).paths, 1U);
  EXPECT_GT(lost.places[0].row(0).minCoeff(), 5.9);
}

TEST(LostPoses, AProfileOfAnotherVersionIsNamed) {
  KnownPaths known;
  Distribution distribution = distribution_of({"panda"});
  distribution.profile = "default,of_tomorrow=1";
  const LostPoses lost = lost_of(distribution, known);
  EXPECT_NE(lost.problem.find("of_tomorrow"), std::string::npos);
  const auto json = nlohmann::json::parse(to_json(lost));
  EXPECT_EQ(json["problem"], lost.problem);
  EXPECT_EQ(json["places"].size(), kLosses);
}

}  // namespace
}  // namespace kinship::plots::lost_poses_test
