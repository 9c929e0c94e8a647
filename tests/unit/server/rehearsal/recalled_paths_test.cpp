// Libraries of paths to recall: made by rehearsals, judged by them, sent with their replies.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <string_view>

#include "robots/kinematics/forward_kinematics.hpp"
#include "server/rehearsal/recall_queries.hpp"
#include "server/rehearsal/rehearsal_reply.hpp"
#include "server/rehearsal/rehearsal_scheduler.hpp"
#include "tests/unit/server/rehearsal/rehearsal_fixture.hpp"

namespace kinship::rehearsal {
namespace {

using namespace std::chrono_literals;

class RecalledPaths : public RehearsalTest {
 protected:
  static RehearsalSchedulerOptions quick() {
    RehearsalSchedulerOptions options;
    options.plan = {.rounds = 1, .max_checks = 2000};
    options.max_queries = 5;
    return options;
  }
  /// Where the sweeps were, or beside that.
  RehearsalKey key_at(const Digest& robot, double x = 0) const {
    const Eigen::Isometry3d T_task_base(Eigen::Translation3d(x, 0, 0));
    return {key_of(robot, x == 0 ? std::nullopt : std::optional(T_task_base)),
            kDefaultExperienceBytes};
  }
  SharedRehearsal wait(RehearsalScheduler& rehearsals, const RehearsalKey& key) const {
    std::promise<SharedRehearsal> known;
    rehearsals.wait(key, clock_.now() + 300s,
                    [&known](const SharedRehearsal& found) { known.set_value(found); });
    return known.get_future().get();
  }
  std::vector<recall::PosedQuery> posed(const Digest& digest, const Starts& starts = {}) {
    return recall_queries(*robot(digest), Eigen::Isometry3d::Identity(),
                          queries_for(digest).queries, starts);
  }
  RecallLibrary library_of(const Digest& digest) {
    const runtime::Robot& known = *robot(digest);
    recall::LibraryMaker maker(known.chain, {known.chain, known.shapes}, posed(digest),
                               {.step = 0.1});
    while (maker.step()) {
    }
    return maker.take().value();
  }

  catalog::ExperienceIndex experience_{*store_, registry_};
  const RehearsalScheduler::Parts parts_{*store_, registry_, clock_, experience_};
};

TEST_F(RecalledPaths, AreMadeOfQueriesWithAScene) {
  report_sweeps(2);
  report_sweeps(1, std::nullopt);
  RecordedScene level = post();
  level.constraint = TaskSpaceRegion();
  report_sweeps(1, level);
  EXPECT_EQ(queries_for(panda_).queries.size(), 4U);
  const std::vector<recall::PosedQuery> made = posed(panda_);
  ASSERT_EQ(made.size(), 3U);
  EXPECT_FALSE(made.front().constraint);
  EXPECT_TRUE(made.back().constraint);
}

TEST_F(RecalledPaths, BeginInTwoBranchesWhereTheOthersBegan) {
  report_sweeps(8);
  const runtime::Robot& ur10e = *robot(ur10e_);
  const std::vector<RecordedQuery> recorded = queries_for(ur10e_).queries;
  const std::vector<recall::PosedQuery> twice = posed(ur10e_, {.usual = {}, .are_recorded = true});
  ASSERT_EQ(twice.size(), 2 * recorded.size());
  bool is_another_branch = false;
  for (std::size_t i = 0; i < twice.size(); ++i) {
    const RecordedQuery& query = recorded[i / 2];
    EXPECT_EQ(twice[i].report, query.path);
    EXPECT_TRUE(kinematics::T_base_transfer(ur10e.chain, twice[i].start)
                    .isApprox(query.T_task_start, 1e-4));
    is_another_branch = is_another_branch || (twice[i].start - twice[i / 2 * 2].start).norm() > 1;
  }
  EXPECT_TRUE(is_another_branch);
  EXPECT_EQ(posed(ur10e_).size(), recorded.size()) << "once from a usual start";
  EXPECT_EQ(posed(panda_, {.usual = {}, .are_recorded = true}).size(), 8U) << "its own, as it did";
}

TEST_F(RecalledPaths, OwnAnswersAreTakenAndAnothersQueriesPlanned) {
  const std::vector<Attempt> attempts = report_sweeps(3);
  const std::vector<recall::PosedQuery> own = posed(panda_);
  ASSERT_EQ(own.size(), 3U);
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_EQ(own[i].report, attempts[i].report_uuid);
    ASSERT_TRUE(own[i].solution);
    EXPECT_EQ(*own[i].solution, attempts[i].path->waypoints());
    EXPECT_EQ(own[i].surroundings.scene.objects.front().name, "post");
  }
  const std::vector<recall::PosedQuery> anothers = posed(ur10e_);
  ASSERT_FALSE(anothers.empty());
  for (const recall::PosedQuery& query : anothers)
    EXPECT_FALSE(query.solution);
  for (const RecallQuery& query : library_of(ur10e_).queries)
    EXPECT_TRUE(query.is_synthetic);
  for (const RecallQuery& query : library_of(panda_).queries)
    EXPECT_FALSE(query.is_synthetic);
}

TEST_F(RecalledPaths, CostsOfGuidesAfterThemStandBesideThoseWithout) {
  report_sweeps(4);
  Subject subject;
  subject.robot = robot(panda_);
  subject.recorded = queries_for(panda_);
  subject.experience =
      std::make_shared<const planning::ExperienceGuide>(subject.robot->chain, TaskExperience{});
  subject.recall =
      std::make_shared<const recall::RecallGuide>(subject.robot->chain, library_of(panda_));
  Rehearsing rehearsing(subject, {.rounds = 1, .max_checks = 5000});
  while (rehearsing.step()) {
  }
  const Rehearsal result = rehearsing.result();
  std::vector<Guide> guides;
  for (const GuideCost& cost : result.costs) {
    guides.push_back(cost.guide);
    EXPECT_EQ(cost.plans, 4U);
    EXPECT_GT(cost.mean_time_s, 0);
  }
  EXPECT_EQ(guides,
            (std::vector{Guide::None, Guide::Retreat, Guide::Recall, Guide::RecallRetreat}));
  const auto cost_of = [&](Guide guide) {
    return *std::ranges::find(result.costs, guide, &GuideCost::guide);
  };
  for (const Guide guide : {Guide::None, Guide::Retreat})
    EXPECT_GE(cost_of(with_recall(guide)).solved, cost_of(guide).solved)
        << "what is not recalled is planned";
}

TEST_F(RecalledPaths, AreKnownOnceRehearsed) {
  report_sweeps(5);
  RehearsalScheduler rehearsals(parts_, quick());
  const RehearsalKey key = key_at(panda_);
  EXPECT_FALSE(rehearsals.library(key));
  EXPECT_EQ(rehearsals.totals().queued, 0U) << "to ask for it begins nothing";
  ASSERT_TRUE(wait(rehearsals, key));
  const SharedLibrary library = rehearsals.library(key);
  ASSERT_TRUE(library);
  EXPECT_FALSE(validate(*library));
  EXPECT_EQ(library->queries.size(), 5U);
  EXPECT_FALSE(rehearsals.library(key_at(ur10e_))) << "they are one robot's";
}

TEST_F(RecalledPaths, WhereThereIsNoneTheNextPathIsReasonToRehearse) {
  report_sweeps(5, std::nullopt);
  RehearsalScheduler rehearsals(parts_, quick());
  const RehearsalKey key = key_at(panda_);
  ASSERT_TRUE(wait(rehearsals, key));
  EXPECT_FALSE(rehearsals.library(key)) << "no scene was recorded";
  const RehearsalKey near = key_at(panda_, 0.5);
  EXPECT_EQ(wait(rehearsals, near), rehearsals.find(identify(key.distribution)));
  report_sweeps(1);
  rehearsals.new_experience("sweep");
  ASSERT_TRUE(wait(rehearsals, near));
  EXPECT_TRUE(rehearsals.library(near)) << "the other placement has none, and serves no more";
  ASSERT_TRUE(wait(rehearsals, key));
  EXPECT_TRUE(rehearsals.library(key));
  EXPECT_EQ(rehearsals.totals().done, 3U);
}

TEST_F(RecalledPaths, AreMadeAgainWhenTheRobotsOwnPathsHaveDoubled) {
  report_sweeps(2);
  RehearsalScheduler rehearsals(parts_, quick());
  const RehearsalKey key = key_at(panda_);
  const auto queries = [&](std::size_t more) {
    report_sweeps(more);
    rehearsals.new_experience("sweep");
    EXPECT_TRUE(wait(rehearsals, key));
    return rehearsals.library(key)->queries.size();
  };
  EXPECT_EQ(queries(0), 2U);
  EXPECT_EQ(queries(1), 2U);
  EXPECT_EQ(queries(1), 4U);
}

TEST_F(RecalledPaths, WhatServesAnotherPlacementIsComparedWithTheExperience) {
  report_sweeps(2);
  RehearsalScheduler rehearsals(parts_, quick());
  const RehearsalKey key = key_at(panda_);
  ASSERT_TRUE(wait(rehearsals, key));
  report_sweeps(2);
  rehearsals.new_experience("sweep");
  EXPECT_TRUE(rehearsals.ask(key_at(panda_, 0.5)));  // one request of each place
  ASSERT_TRUE(wait(rehearsals, key));
  EXPECT_EQ(rehearsals.library(key)->queries.size(), 4U);
  EXPECT_EQ(rehearsals.totals().done, 2U);
}

TEST_F(RecalledPaths, WhereOthersGraspOutOfReachTheGoalOfTheRequestIsPlanned) {
  report_sweeps(3);
  RehearsalScheduler rehearsals(parts_, quick());
  RehearsalKey key = key_at(ur10e_, 3);
  const SharedRehearsal nothing = wait(rehearsals, key);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->queries, 0U);
  EXPECT_EQ(nothing->guide, Guide::None);
  EXPECT_FALSE(rehearsals.library(key));

  const kinematics::Chain& chain = robot(ur10e_)->chain;
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(6, -1.2);
  Eigen::VectorXd goal = start;
  goal[0] += 1;
  RehearsalKey told = key_at(ur10e_, 3.5);
  told.start = start;
  told.T_task_goal = *told.distribution.T_task_base * kinematics::T_base_transfer(chain, goal);
  ASSERT_TRUE(wait(rehearsals, told));
  const SharedLibrary library = rehearsals.library(told);
  ASSERT_TRUE(library);
  EXPECT_EQ(library->queries.size(), 3U);
  for (const RecallQuery& query : library->queries) {
    EXPECT_TRUE(query.is_synthetic);
    EXPECT_TRUE((query.T_task_base * kinematics::T_base_transfer(chain, query.goal))
                    .isApprox(*told.T_task_goal, 1e-4));
  }
}

TEST_F(RecalledPaths, AnotherPlacementIsServedByTheNearestRehearsedOne) {
  report_sweeps(5);
  RehearsalScheduler rehearsals(parts_, quick());
  const RehearsalKey first = key_at(panda_), near = key_at(panda_, 1), far = key_at(panda_, 2);
  const SharedRehearsal known = wait(rehearsals, first);
  ASSERT_TRUE(known);
  EXPECT_EQ(rehearsals.library(near), rehearsals.library(first)) << "also before it is asked for";
  EXPECT_EQ(wait(rehearsals, near), known);
  EXPECT_EQ(rehearsals.totals().queued, 0U) << "one request is no reason for a rehearsal";
  EXPECT_EQ(rehearsals.totals().done, 1U);

  EXPECT_EQ(rehearsals.ask(near), known);
  EXPECT_EQ(rehearsals.totals().queued, 1U) << "the second one is";

  EXPECT_FALSE(rehearsals.library(far));
  EXPECT_FALSE(rehearsals.ask(far)) << "two metres are too far";
  EXPECT_EQ(rehearsals.ask(key_at(ur10e_)), nullptr) << "another robot's are of no use";
}

TEST_F(RecalledPaths, APlacementKeepsWhatServesItUntilItsOwnIsComplete) {
  report_sweeps(24);
  RehearsalSchedulerOptions options = quick();
  options.max_queries = 24;  // enough for a first result of a few
  options.processor_fraction = 1;
  std::promise<void> done;
  options.log = [&, count = 0](std::string_view) mutable {
    if (++count == 2)
      done.set_value();
  };
  RehearsalScheduler rehearsals(parts_, options);
  const RehearsalKey first = key_at(panda_), near = key_at(panda_, 0.5);
  const SharedRehearsal known = wait(rehearsals, first);
  ASSERT_TRUE(known && rehearsals.library(first));
  rehearsals.ask(near);
  rehearsals.ask(near);
  std::future<void> is_done = done.get_future();
  int asked = 0;
  do {
    const SharedRehearsal served = rehearsals.ask(near);
    EXPECT_TRUE(served && served->is_complete);
    EXPECT_TRUE(rehearsals.library(near));
    ++asked;
  } while (is_done.wait_for(1ms) != std::future_status::ready && !HasFailure());
  EXPECT_GT(asked, 1);
}

TEST_F(RecalledPaths, TheSecondRequestRehearsesAPlacementForItself) {
  report_sweeps(3);
  std::promise<void> first_done, second_done;
  RehearsalSchedulerOptions options = quick();
  options.processor_fraction = 1;
  options.log = [&, count = 0](std::string_view) mutable {
    (count++ == 0 ? first_done : second_done).set_value();
  };
  RehearsalScheduler rehearsals(parts_, options);
  const RehearsalKey first = key_at(panda_), near = key_at(panda_, 0.5);
  const SharedRehearsal known = wait(rehearsals, first);
  EXPECT_EQ(wait(rehearsals, near), known);
  EXPECT_FALSE(rehearsals.find(identify(near.distribution))) << "it is another placement's";
  rehearsals.ask(near);
  ASSERT_GT(rehearsals.totals().queued + rehearsals.totals().done, 1U) << "it was begun";
  second_done.get_future().wait();
  rehearsals.stop();  // keeps what was said to be done
  EXPECT_EQ(rehearsals.totals().done, 2U);
  const SharedRehearsal own = rehearsals.find(identify(near.distribution));
  ASSERT_TRUE(own);
  EXPECT_NE(own, known);
}

TEST_F(RecalledPaths, AReplyCarriesThemUntilTheClientHasThem) {
  report_sweeps(5);
  RehearsalScheduler rehearsals(parts_, quick());
  FetchRequest request;
  request.task = "sweep";
  request.robot = panda_;
  request.profile = "default,components=2";
  request.deadline = 300s;
  request.experience_bytes = kDefaultExperienceBytes;
  request.rehearsed = true;
  const auto reply_to = [&](FetchStatus status) {
    std::promise<FetchReply> promise;
    FetchReply reply;
    reply.status = status;
    with_rehearsal(rehearsals, request, clock_.now(),
                   [&](const FetchReply& sent) { promise.set_value(sent); })(reply);
    return promise.get_future().get();
  };
  const FetchReply first = reply_to(FetchStatus::Pending);
  ASSERT_TRUE(first.recall);
  EXPECT_FALSE(validate(*first.recall));
  EXPECT_TRUE(reply_to(FetchStatus::Ready).recall) << "it is not known to be held";
  EXPECT_FALSE(reply_to(FetchStatus::Busy).recall);
  request.known_recall = first.recall->revision;
  const FetchReply second = reply_to(FetchStatus::Ready);
  EXPECT_FALSE(second.recall);
  EXPECT_TRUE(second.rehearsal);
  request.known_recall = first.recall->revision + 1;
  EXPECT_TRUE(reply_to(FetchStatus::Ready).recall) << "another one is held";
}

}  // namespace
}  // namespace kinship::rehearsal
