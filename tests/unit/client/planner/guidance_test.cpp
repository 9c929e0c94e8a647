#include "client/guided/guidance.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/random_values.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::guided::guidance_test {
namespace {

constexpr Eigen::Index kDof = 2;

Mixture one_component(Eigen::Index dimension) {
  return Mixture(Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Zero(dimension, 1),
                 {Eigen::MatrixXd::Identity(dimension, dimension)});
}

FetchReply ready(double guided_share = 0.9, Eigen::Index dimension = kDof) {
  Distribution distribution;
  distribution.id.bytes[0] = 0xab;
  distribution.revision = 3;
  distribution.configurations = 400;
  Source& source = distribution.sources.emplace_back();
  source.label = "panda";
  source.paths = source.generation = 60;
  source.poses = 900;
  source.poses_solved = 880;
  distribution.mixture = one_component(dimension);
  distribution.advice.recommended_share = 0.1;
  distribution.advice.guided_share = guided_share;
  FetchReply reply;
  reply.status = FetchStatus::Ready;
  reply.distribution = distribution;
  return reply;
}

FetchReply status_only(FetchStatus status) {
  FetchReply reply;
  reply.status = status;
  return reply;
}

GuidanceOptions wanted() {
  GuidanceOptions wanted;
  wanted.task = "box_to_shelf";
  wanted.dof = kDof;
  return wanted;
}

Eigen::Isometry3d placement(double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); }

Problem problem_at(double x, std::uint64_t seed = 0) {
  Problem problem;
  problem.T_task_base = placement(x);
  problem.seed = seed;
  return problem;
}

GuidanceAnswer answer_to(const Result<FetchReply>& reply,
                         const GuidanceOptions& for_what = wanted()) {
  return fetch_guidance([&](const FetchRequest&) { return reply; }, for_what, placement(0));
}

TEST(FetchGuidance, TakesTheServersShareUnlessToldOtherwise) {
  EXPECT_EQ(answer_to(ready(0.9)).guidance->guided_fraction, 0.9);
  GuidanceOptions own_share = wanted();
  own_share.sampling.guided_fraction = 0.25;
  EXPECT_EQ(answer_to(ready(0.9), own_share).guidance->guided_fraction, 0.25);
}

TEST(FetchGuidance, TellsIdRevisionSourcesAndShare) {
  const GuidanceAnswer answer = answer_to(ready());
  EXPECT_EQ(answer.message,
            "distribution ab0000000000 revision 3, 1 components fitted to 400 configurations from "
            "panda (60 paths); share 0.90, the first query guided with probability 0.64");
  EXPECT_EQ(answer.guidance->revision, 3U);
  EXPECT_EQ(answer.why_not, NoGuidance::None);
}

TEST(FetchGuidance, TellsHowTheQueriesAreDivided) {
  const auto tail = [](const SamplingModeOptions& sampling) {
    GuidanceOptions told = wanted();
    told.sampling = sampling;
    const std::string message = answer_to(ready(), told).message;
    return message.substr(message.find("; ") + 2);
  };
  EXPECT_EQ(tail({{}, 0.0}), "share 0.90");
  EXPECT_EQ(tail({0.5, 0.025}), "share 0.50, 2.5 % of the queries uniform as control");
  EXPECT_EQ(tail({0.5, {}}), "share 0.50, the first query guided with probability 0.64");
  EXPECT_EQ(tail({0.0, {}}), "uniform");
}

TEST(FetchGuidance, TakesTheRehearsedGuideAndUntilThereIsOneLeavesTheMixtureOut) {
  const kinematics::Chain chain = kinship::test::PlanarArm{{0.5, 0.5}}.chain();
  const KnownExperience ways{std::make_shared<planning::ExperienceGuide>(chain, TaskExperience{}),
                             nullptr};
  FetchReply reply = ready();
  const auto guide = [&](const KnownExperience& known) {
    return fetch_guidance([&](const FetchRequest&) { return Result<FetchReply>(reply); }, wanted(),
                          placement(0), known)
        .guidance->guide;
  };
  EXPECT_EQ(guide(ways), Guide::RecallRetreatWays);
  EXPECT_EQ(guide({}), Guide::All) << "the mixture is all there is";
  reply.rehearsal.emplace().message = "not rehearsed";
  EXPECT_EQ(guide(ways), Guide::RecallRetreatWays);
  reply.rehearsal->guide = Guide::None;
  EXPECT_EQ(guide(ways), Guide::None) << "no recorded query could be planned";
  reply.rehearsal->costs.push_back({.guide = Guide::Mixture});
  reply.rehearsal->guide = Guide::Mixture;
  EXPECT_EQ(guide(ways), Guide::Mixture);
}

TEST(FetchGuidance, AsksForTaskRobotPlacementProfileAndSelection) {
  GuidanceOptions special = wanted();
  special.selection.since_ms = 77;
  special.profile = "paper";
  special.robot.bytes[5] = 7;
  special.wait = std::chrono::milliseconds(1234);
  FetchRequest seen;
  fetch_guidance(
      [&](const FetchRequest& request) {
        seen = request;
        return Result<FetchReply>(ready());
      },
      special, placement(0.5));
  EXPECT_EQ(seen.task, "box_to_shelf");
  EXPECT_EQ(seen.profile, "paper");
  EXPECT_EQ(seen.selection, special.selection);
  EXPECT_EQ(seen.robot, special.robot);
  EXPECT_EQ(seen.deadline.count(), 1234);
  EXPECT_EQ(seen.T_task_base->translation().x(), 0.5);
}

TEST(FetchGuidance, TellsNobodyFromNothingFromFailure) {
  EXPECT_EQ(answer_to(Error{ErrorCode::Unavailable, "nobody"}).why_not, NoGuidance::NoServer);
  EXPECT_EQ(answer_to(Error{ErrorCode::Internal, "odd"}).why_not, NoGuidance::Failed);
  EXPECT_EQ(answer_to(status_only(FetchStatus::NoExperience)).why_not, NoGuidance::NoExperience);
  EXPECT_EQ(answer_to(status_only(FetchStatus::UnknownRobot)).why_not, NoGuidance::NotFound);
  EXPECT_EQ(answer_to(status_only(FetchStatus::Failed)).why_not, NoGuidance::NotFound);
  EXPECT_EQ(answer_to(status_only(FetchStatus::Pending)).why_not, NoGuidance::Failed);
  EXPECT_EQ(answer_to(status_only(FetchStatus::Busy)).why_not, NoGuidance::Failed);
  EXPECT_EQ(answer_to(status_only(FetchStatus::Refused)).why_not, NoGuidance::Failed);
}

TEST(FetchGuidance, EveryRefusalHasAReason) {
  for (const FetchStatus status :
       {FetchStatus::NoExperience, FetchStatus::UnknownRobot, FetchStatus::Failed,
        FetchStatus::Pending, FetchStatus::Busy, FetchStatus::Refused, FetchStatus::Ready})
    EXPECT_NE(answer_to(status_only(status)).message, "");
}

TEST(FetchGuidance, RefusesADistributionThatDoesNotFitTheRobot) {
  const GuidanceAnswer answer = answer_to(ready(0.9, kDof + 1));
  EXPECT_FALSE(answer.guidance);
  EXPECT_EQ(answer.why_not, NoGuidance::Failed);
  EXPECT_FALSE(answer_to(ready(1.5)).guidance);
}

TEST(GuidanceCache, AsksOncePerPlacementWithinAMillimetre) {
  int asked = 0;
  GuidanceCache cache(
      [&](const FetchRequest&) {
        ++asked;
        return Result<FetchReply>(ready());
      },
      wanted());
  EXPECT_TRUE(cache.ask(placement(0.1)).second);
  EXPECT_FALSE(cache.ask(placement(0.1001)).second);
  EXPECT_TRUE(cache.ask(placement(0.2)).second);
  EXPECT_EQ(asked, 2);
}

TEST(GuidanceCache, TellsTheGoalOfAProblemAsAPose) {
  std::vector<FetchRequest> seen;
  GuidanceOptions with_chain = wanted();
  with_chain.chain = kinship::test::PlanarArm{{0.5, 0.5}}.chain();
  GuidanceCache cache(
      [&](const FetchRequest& request) {
        seen.push_back(request);
        return Result<FetchReply>(ready());
      },
      with_chain);
  Problem problem = problem_at(1);
  problem.goal_configurations = Eigen::MatrixXd::Zero(kDof, 1);
  cache.ask(problem);
  problem = problem_at(2);
  problem.T_task_goal = placement(7);
  cache.ask(problem);
  cache.ask(problem_at(3).T_task_base);
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_TRUE(seen[0].T_task_goal->isApprox(
      placement(1) * kinematics::T_base_transfer(*with_chain.chain, Eigen::VectorXd::Zero(kDof))));
  EXPECT_TRUE(seen[1].T_task_goal->isApprox(placement(7)));
  EXPECT_FALSE(seen[2].T_task_goal);
  EXPECT_TRUE(seen[0].to_configuration);
  EXPECT_FALSE(seen[1].to_configuration);
}

TEST(GuidanceCache, AMissingPlacementIsAskedForAsMissing) {
  std::vector<bool> placed;
  GuidanceCache cache(
      [&](const FetchRequest& request) {
        placed.push_back(request.T_task_base.has_value());
        return Result<FetchReply>(ready());
      },
      wanted());
  EXPECT_TRUE(cache.ask(std::nullopt).second);
  EXPECT_FALSE(cache.ask(std::nullopt).second);
  EXPECT_TRUE(cache.ask(placement(0)).second);
  EXPECT_EQ(placed, (std::vector<bool>{false, true}));
  EXPECT_NE(cache.choose(Problem{}).guidance, nullptr);
}

TEST(GuidanceCache, FindsOnlyWhatWasAskedAndGot) {
  GuidanceCache cache(
      [](const FetchRequest& request) {
        const bool experienced = request.T_task_base->translation().x() > 0;
        return Result<FetchReply>(experienced ? ready() : status_only(FetchStatus::NoExperience));
      },
      wanted());
  cache.ask(placement(-1));
  cache.ask(placement(1));
  EXPECT_EQ(cache.choose(problem_at(-1)).guidance, nullptr);
  EXPECT_EQ(cache.choose(problem_at(-1)).sampling_mode, SamplingMode::Uniform);
  EXPECT_EQ(cache.choose(problem_at(0.5)).guidance, nullptr);
  ASSERT_NE(cache.choose(problem_at(1)).guidance, nullptr);
  EXPECT_EQ(cache.choose(problem_at(1)).guidance->revision, 3U);
}

TEST(GuidanceCache, AGuideThatNeedsNoExperienceAsksNoServerAndKeepsItsEvidence) {
  GuidanceOptions alone = wanted();
  alone.guide = Guide::Retreat;
  alone.chain = test::planar_robot().chain;
  GuidanceCache cache(nullptr, alone);
  const GuidanceAnswer& answer = cache.ask(placement(0)).first;
  ASSERT_TRUE(answer.guidance);
  EXPECT_EQ(answer.message,
            "guide retreat, which needs no experience; share 1.00, the first query guided with "
            "probability 0.64");
  EXPECT_EQ(answer.guidance->guide, Guide::Retreat);
  EXPECT_FALSE(answer.guidance->distribution_id);
  ASSERT_NE(answer.guidance->experience, nullptr);

  PlannedProblem planned;
  planned.outcome = Outcome::Solved;
  for (int i = 0; i < 20; ++i)
    for (const SamplingMode mode : {SamplingMode::Guided, SamplingMode::Control}) {
      planned.result.sampling_mode = mode;
      planned.result.collision_checks = mode == SamplingMode::Guided ? 10'000 : 1000;
      cache.add(planned);
    }
  cache.ask(placement(1));
  int guided = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    guided += cache.choose(problem_at(1, seed)).sampling_mode == SamplingMode::Guided ? 1 : 0;
  EXPECT_LT(guided, 20) << "what was learned at another placement";

  alone.guide = Guide::None;
  GuidanceCache none(nullptr, alone);
  none.ask(placement(0));
  EXPECT_EQ(none.choose(problem_at(0)).sampling_mode, SamplingMode::Uniform);
}

GuidanceOptions wanted_of_the_arm() {
  GuidanceOptions arms = wanted();
  arms.chain = test::planar_robot().chain;
  arms.dof = arms.chain->dof();
  return arms;
}

TEST(GuidanceCache, PathsToRecallAreSentOnceAndServeAllPlacements) {
  kinship::test::RandomValues values(5);
  const RecallLibrary library = values.recall_library(wanted_of_the_arm().dof);
  std::vector<std::uint64_t> known;
  GuidanceCache cache(
      [&](const FetchRequest& request) {
        known.push_back(request.known_recall);
        FetchReply reply = status_only(FetchStatus::NoExperience);
        if (request.known_recall != library.revision)
          reply.recall = library;
        return Result<FetchReply>(reply);
      },
      wanted_of_the_arm());
  for (const double x : {0.0, 1.0}) {
    const GuidanceAnswer& answer = cache.ask(placement(x)).first;
    ASSERT_TRUE(answer.guidance) << answer.message;
    ASSERT_TRUE(answer.guidance->recall);
    EXPECT_EQ(answer.guidance->recall->library().revision, library.revision);
  }
  EXPECT_EQ(known, (std::vector<std::uint64_t>{0, library.revision}));
}

TEST(GuidanceCache, PathsOfAnotherNumberOfJointsAreNotTaken) {
  kinship::test::RandomValues values(5);
  FetchReply reply = status_only(FetchStatus::NoExperience);
  reply.recall = values.recall_library(wanted_of_the_arm().dof + 1);
  EXPECT_FALSE(answer_to(reply, wanted_of_the_arm()).guidance);
}

TEST(GuidanceCache, PathsThatDoNotDoWhatTheyPromiseAreTrustedLess) {
  GuidanceCache cache([](const FetchRequest&) { return Result<FetchReply>(ready()); }, wanted());
  cache.ask(placement(0));
  EXPECT_EQ(cache.choose(problem_at(0)).recall_trust, 1);
  PlannedProblem planned;
  planned.recall_expected = 0.9;
  planned.result.found_by = FoundBy::Search;
  for (int i = 0; i < 20; ++i)
    cache.add(planned);
  const double doubted = cache.choose(problem_at(0)).recall_trust;
  EXPECT_LT(doubted, 0.2);
  planned.result.found_by = FoundBy::Recalled;
  for (int i = 0; i < 200; ++i)
    cache.add(planned);
  EXPECT_GT(cache.choose(problem_at(0)).recall_trust, 0.8);
  EXPECT_LE(cache.choose(problem_at(0)).recall_trust, 1);
}

/// Guided queries at one placement that cost ten times as much as control ones.
TEST(GuidanceCache, WhatItIsToldChangesTheArmsOfAllPlacements) {
  GuidanceCache cache([](const FetchRequest&) { return Result<FetchReply>(ready()); }, wanted());
  cache.ask(placement(0));
  cache.ask(placement(1));
  const auto guided = [&cache] {
    int count = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed)
      count += cache.choose(problem_at(1, seed)).sampling_mode == SamplingMode::Guided ? 1 : 0;
    return count;
  };
  EXPECT_GT(guided(), 100);
  PlannedProblem planned;
  planned.outcome = Outcome::Solved;
  for (int i = 0; i < 10; ++i)
    for (const SamplingMode mode : {SamplingMode::Guided, SamplingMode::Control}) {
      planned.result.sampling_mode = mode;
      planned.result.collision_checks = mode == SamplingMode::Guided ? 10'000 : 1000;
      cache.add(planned);
    }
  EXPECT_LT(guided(), 20);
}

TEST(GuidanceCache, DoesNotAskAgainWhenNobodyAnswered) {
  int asked = 0;
  GuidanceCache cache(
      [&](const FetchRequest&) {
        ++asked;
        return Result<FetchReply>(Error{ErrorCode::Unavailable, "no server answered in 5 s"});
      },
      wanted());
  EXPECT_EQ(cache.ask(placement(0.1)).first.why_not, NoGuidance::NoServer);
  EXPECT_EQ(cache.ask(placement(0.2)).first.why_not, NoGuidance::NoServer);
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace kinship::guided::guidance_test
