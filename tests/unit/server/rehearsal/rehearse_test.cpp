#include "server/rehearsal/rehearse.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/server/rehearsal/rehearsal_fixture.hpp"

namespace kinship::rehearsal {
namespace {

class Rehearse : public RehearsalTest {
 protected:
  Subject subject_of(const Digest& digest, const TaskExperience& experience = {}) {
    Subject subject;
    subject.robot = robot(digest);
    subject.recorded = queries_for(digest);
    subject.experience =
        std::make_shared<const planning::ExperienceGuide>(subject.robot->chain, experience);
    return subject;
  }
  static Rehearsal rehearsed(Subject subject, std::size_t rounds = 1) {
    Rehearsing rehearsing(std::move(subject), {.rounds = rounds, .max_checks = 5000});
    while (rehearsing.step()) {
    }
    return rehearsing.result();
  }
};

TEST_F(Rehearse, AQueryIsWhereThePathBeganAndEnded) {
  const std::vector<Attempt> attempts = report_sweeps(2);
  const RecordedQueries found = queries_for(panda_);
  ASSERT_EQ(found.queries.size(), 2U);
  const RecordedQuery& query = found.queries.front();
  const Eigen::MatrixXd& waypoints = attempts.front().path->waypoints();
  const kinematics::Chain& chain = robot(panda_)->chain;
  EXPECT_EQ(query.path, attempts.front().report_uuid);
  EXPECT_TRUE(
      query.T_task_start.isApprox(kinematics::T_base_transfer(chain, waypoints.col(0)), 1e-9));
  EXPECT_TRUE(
      query.T_task_goal.isApprox(kinematics::T_base_transfer(chain, waypoints.rightCols(1)), 1e-9));
  ASSERT_TRUE(query.scene);
  EXPECT_EQ(query.scene->objects.front().name, "post");
  ASSERT_TRUE(query.own);
  EXPECT_EQ(*query.own, waypoints);
  EXPECT_FALSE(queries_for(ur10e_).queries.front().own) << "another arm's";
  EXPECT_EQ(found.steps.step, 0.1);
  EXPECT_EQ(found.steps.overshoot, 1);
}

TEST_F(Rehearse, OfManyQueriesSomeAreTakenFromBeginningToEnd) {
  const std::vector<Attempt> attempts = report_sweeps(30);
  const RecordedQueries found = queries_for(panda_, 3);
  ASSERT_EQ(found.queries.size(), 3U);
  EXPECT_EQ(found.queries.back().path, attempts.back().report_uuid);
  EXPECT_EQ(found.queries.front().path, attempts[9].report_uuid);
}

TEST_F(Rehearse, AnotherArmBeginsWithItsHandWhereThePathBegan) {
  report_sweeps(1);
  const RecordedQuery query = queries_for(ur10e_).queries.front();
  const auto posed = pose_query(*robot(ur10e_), Eigen::Isometry3d::Identity(), query);
  ASSERT_TRUE(posed);
  const kinematics::Chain& chain = robot(ur10e_)->chain;
  EXPECT_TRUE(
      kinematics::T_base_transfer(chain, posed->query.start).isApprox(query.T_task_start, 1e-4));
  ASSERT_GT(posed->query.goals.cols(), 1) << "every branch of the goal";
  for (const auto& goal : posed->query.goals.colwise())
    EXPECT_TRUE(kinematics::T_base_transfer(chain, goal).isApprox(query.T_task_goal, 1e-4));
  EXPECT_FALSE(posed->world->collides(posed->query.start));
  EXPECT_EQ(posed->query.without, query.path) << "its answer is not followed";
}

TEST_F(Rehearse, ARobotBeginsAsTheOthersIfTheirStartsSpreadAndItsOwnIsAmongThem) {
  report_sweeps(8);
  const kinematics::Chain& ur10e = robot(ur10e_)->chain;
  const Eigen::Isometry3d at_task = Eigen::Isometry3d::Identity();
  std::vector<RecordedQuery> recorded = queries_for(ur10e_).queries;
  const auto are_recorded = [&](const Eigen::VectorXd& usual) {
    return find_starts(ur10e, at_task, recorded, usual).are_recorded;
  };
  const auto among = pose_query(*robot(ur10e_), at_task, recorded.front());
  ASSERT_TRUE(among);
  EXPECT_TRUE(are_recorded(among->query.start));
  EXPECT_TRUE(are_recorded({})) << "nothing else is known";
  EXPECT_FALSE(are_recorded(Eigen::VectorXd::Zero(6))) << "its hand is far from all of them";
  EXPECT_FALSE(
      find_starts(robot(panda_)->chain, at_task, queries_for(panda_).queries, {}).are_recorded)
      << "all are its own";
  recorded.front().T_task_start.translation().x() += 5;
  EXPECT_FALSE(are_recorded(Eigen::VectorXd::Zero(6))) << "one far off says nothing";
  for (RecordedQuery& query : recorded)
    query.T_task_start = recorded.back().T_task_start;
  EXPECT_FALSE(are_recorded(among->query.start)) << "the others begin at home";
}

TEST_F(Rehearse, ItsOwnQueriesStandWhereTheyStood) {
  const Eigen::Isometry3d then(Eigen::Translation3d(2, 1, 0) *
                               Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  const Eigen::Isometry3d today = then * Eigen::Translation3d(0.02, 0, 0);
  const std::vector<Attempt> attempts = report_sweeps(1, post(then), then);
  const RecordedQuery own = queries_for(panda_).queries.front();
  ASSERT_TRUE(own.own);
  EXPECT_TRUE(own.T_task_base.isApprox(then, 1e-9));
  const auto posed = pose_query(*robot(panda_), today, own);
  ASSERT_TRUE(posed);
  EXPECT_TRUE(posed->query.T_task_base.isApprox(then, 1e-9));
  EXPECT_TRUE(posed->surroundings.T_task_base.isApprox(then, 1e-9));
  EXPECT_EQ(posed->query.start, attempts.front().path->waypoints().col(0));
  const auto others = pose_query(*robot(ur10e_), today, queries_for(ur10e_).queries.front());
  ASSERT_TRUE(others);
  EXPECT_TRUE(others->query.T_task_base.isApprox(today, 1e-9)) << "another arm stands elsewhere";
}

TEST_F(Rehearse, WhatARobotCannotReachIsLeftOut) {
  report_sweeps(2);
  Subject far = subject_of(ur10e_);
  far.T_task_base = Eigen::Translation3d(5, 0, 0);
  const Rehearsal result = rehearsed(far);
  EXPECT_EQ(result.queries, 0U);
  EXPECT_EQ(result.left_out, 2U);
  EXPECT_TRUE(result.is_complete);
  EXPECT_EQ(result.guide, Guide::None) << "where others went leads nowhere";
  EXPECT_FALSE(result.message.empty());
}

TEST_F(Rehearse, WhereQueriesAskForOneConfigurationTheyArePlannedToOne) {
  report_sweeps(4);
  for (const Digest& digest : {panda_, ur10e_}) {
    Subject subject = subject_of(digest);
    const Rehearsal to_poses = rehearsed(subject);
    subject.to_configuration = true;
    const Rehearsal to_one = rehearsed(subject);
    ASSERT_EQ(to_one.queries, 4U);
    EXPECT_NE(to_one.costs[0].mean_checks, to_poses.costs[0].mean_checks);
  }
}

TEST_F(Rehearse, ADrawnConfigurationThatNoGuideReachesIsLeftOut) {
  report_sweeps(4);
  for (const Digest& digest : {panda_, ur10e_}) {
    Subject subject = subject_of(digest);
    subject.to_configuration = true;
    Rehearsing rehearsing(subject, {.rounds = 2, .max_checks = 1});
    while (rehearsing.step()) {
    }
    const Rehearsal result = rehearsing.result();
    EXPECT_EQ(result.queries, digest == panda_ ? 4U : 0U) << "a robot's own goal was reached once";
    EXPECT_EQ(result.queries + result.left_out, 4U);
  }
}

TEST_F(Rehearse, EveryGuideThatThereIsPlansEveryQuery) {
  report_sweeps(3);
  const Rehearsal without = rehearsed(subject_of(panda_), 2);
  ASSERT_EQ(without.costs.size(), 2U) << "neither a mixture nor stored ways";
  EXPECT_EQ(without.costs[0].guide, Guide::None);
  EXPECT_EQ(without.costs[1].guide, Guide::Retreat);
  EXPECT_EQ(without.queries, 3U);
  for (const GuideCost& cost : without.costs)
    EXPECT_EQ(cost.plans, 6U) << "each query in each round";

  Subject with = subject_of(panda_, [&] {
    TaskExperience experience;
    experience.revision = 1;
    experience.paths.push_back(
        {panda_, Uuid::random(), {Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()}});
    return experience;
  }());
  const Mixture mixture(Eigen::VectorXd::Ones(1), robot(panda_)->chain.lower() * 0.5,
                        {Eigen::MatrixXd::Identity(7, 7)});
  with.mixtures = {mixture, mixture};
  EXPECT_EQ(rehearsed(with).costs.size(), 8U) << "all without recall";
  with.mixtures[1].reset();
  EXPECT_EQ(rehearsed(with).costs.size(), 4U) << "of half of the queries nothing could be said";
}

TEST(Cheapest, GoesByTimeAndByPreparationAmongThoseAboutAsFast) {
  EXPECT_EQ(cheapest(std::vector<GuideCost>{{Guide::None, 20, 20, 900, 900, 0.004},
                                            {Guide::Ways, 20, 20, 300, 300, 0.006}}),
            Guide::None)
      << "fewer checks, more time";
  std::vector<GuideCost> costs{{Guide::None, 20, 20, 900, 900, 0.004},
                               {Guide::Mixture, 20, 20, 290, 290, 0.00200},
                               {Guide::Ways, 20, 20, 300, 300, 0.00205}};
  EXPECT_EQ(cheapest(costs), Guide::Ways);
  costs[2].mean_time_s = 0.00207;
  EXPECT_EQ(cheapest(costs), Guide::Mixture);
}

TEST(Cheapest, OfThoseThatRecallAlikeTheBestSearchIsTaken) {
  const std::vector<GuideCost> costs{{Guide::None, 20, 20, 900, 900, 0.004},
                                     {Guide::Retreat, 20, 20, 300, 300, 0.002},
                                     {Guide::Mixture, 20, 20, 300, 300, 0.002},
                                     {Guide::Recall, 20, 20, 30, 30, 0.001},
                                     {Guide::RecallRetreat, 20, 20, 30, 30, 0.00102},
                                     {Guide::RecallMixture, 20, 20, 30, 30, 0.001}};
  EXPECT_EQ(cheapest(costs), Guide::RecallRetreat) << "all was recalled: other queries may not be";
}

TEST(Cheapest, GoesByChecksWhereNoTimeIsKnown) {
  EXPECT_EQ(cheapest(std::vector<GuideCost>{{Guide::None, 20, 20, 900, 900, 0.004},
                                            {Guide::Ways, 20, 20, 300, 300, 0}}),
            Guide::Ways);
}

TEST_F(Rehearse, TheCheapestGuideIsTakenAndEqualSubjectsNeedEqualChecks) {
  report_sweeps(4);
  Rehearsal result = rehearsed(subject_of(panda_), 3);
  EXPECT_EQ(result.guide, cheapest(result.costs));
  Rehearsal again = rehearsed(subject_of(panda_), 3);
  for (Rehearsal* each : {&result, &again}) {
    each->guide = Guide::All;
    for (GuideCost& cost : each->costs) {
      EXPECT_GT(cost.mean_time_s, 0);
      EXPECT_LT(cost.mean_time_s, 10);
      cost.mean_time_s = 0;
    }
  }
  EXPECT_EQ(again, result);
}

TEST_F(Rehearse, AHopelessGuideIsLeftAfterARound) {
  report_sweeps(20);
  Rehearsing rehearsing(subject_of(panda_), {.rounds = 2, .max_checks = 5000});
  while (rehearsing.rounds() == 0 && rehearsing.step()) {
  }
  const std::vector<GuideCost> first = rehearsing.result().costs;
  while (rehearsing.step()) {
  }
  const double least = std::ranges::min(first, {}, &GuideCost::mean_time_s).mean_time_s;
  for (const GuideCost& cost : rehearsing.result().costs) {
    const auto before = std::ranges::find(first, cost.guide, &GuideCost::guide);
    EXPECT_EQ(cost.plans, before->mean_time_s > 1.5 * least ? 20U : 40U);
  }
}

TEST_F(Rehearse, AConstraintIsKept) {
  RecordedScene scene = post();
  TaskSpaceRegion level;
  level.bounds.row(0).setConstant(-10);
  level.bounds.row(1).setConstant(10);
  scene.constraint = level;
  report_sweeps(1, scene);
  const RecordedQuery query = queries_for(panda_).queries.front();
  const auto posed = pose_query(*robot(panda_), Eigen::Isometry3d::Identity(), query);
  ASSERT_TRUE(posed);
  ASSERT_TRUE(posed->constraint);
  EXPECT_TRUE(posed->constraint->holds(posed->query.start));
}

}  // namespace
}  // namespace kinship::rehearsal
