#include "robots/recall/recall.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "robots/collision/edge_prover.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/guided_sampler.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::recall::recall_test {
namespace {

using test_support::asked;
using test_support::kStep;
using test_support::made_shelf;
using test_support::MadeShelf;
using test_support::ShelfCell;

constexpr RecallOptions kOptions{.step = kStep};

/// A query that was not recorded, and its world.
struct Fresh {
  Fresh(const MadeShelf& made, PosedQuery its, bool is_pose)
      : posed(std::move(its)),
        query(asked(made.cell, made.library, posed, is_pose)),
        world(made.cell.solids, posed.surroundings) {}

  PosedQuery posed;
  Query query;
  collision::CollisionWorld world;
};

class Recalls : public testing::TestWithParam<bool> {
 protected:
  /// A library that is tried as long as it has a candidate.
  static RecallLibrary patient() {
    RecallLibrary library = made_shelf().library;
    library.search_checks = 1e6;
    return library;
  }
  std::vector<Fresh> fresh() const {
    std::vector<Fresh> found;
    for (PosedQuery& posed : made_shelf().cell.queries(100, 8))
      found.emplace_back(made_shelf(), std::move(posed), GetParam());
    return found;
  }
  /// From the start to a goal, or to the goal's pose.
  void expect_ends(const Query& query, const Eigen::MatrixXd& path) const {
    EXPECT_EQ(path.col(0), query.start);
    const Eigen::VectorXd last = path.rightCols<1>();
    if (GetParam())
      EXPECT_TRUE(inverse::reaches(made_shelf().cell.chain, query.T_base_goal, last));
    else
      EXPECT_EQ((query.goals.colwise() - last).colwise().norm().minCoeff(), 0);
    EXPECT_TRUE(((path.colwise() - query.bounds.row(0).transpose().eval()).array() >= 0).all());
    EXPECT_TRUE(((path.colwise() - query.bounds.row(1).transpose().eval()).array() <= 0).all());
  }

  const RecallGuide guide_{made_shelf().cell.chain, patient()};
};

TEST_P(Recalls, WhatTheyReturnIsAWholeFreePath) {
  int solved = 0;
  for (Fresh& each : fresh()) {
    const planning::IsFree is_free = planning::free_in(each.world);
    const std::uint64_t before = each.world.checks();
    const RecallSummary found = recall(guide_, each.query, is_free, kOptions);
    EXPECT_EQ(found.collision_checks, each.world.checks() - before);
    EXPECT_GE(found.expected, 0);
    EXPECT_LE(found.expected, 1);
    if (!found.waypoints)
      continue;
    ++solved;
    expect_ends(each.query, *found.waypoints);
    const Eigen::Index last = found.waypoints->cols() - 1;
    for (const auto& q : found.waypoints->colwise())
      EXPECT_FALSE(each.world.collides(q));
    EXPECT_LE((found.waypoints->rightCols(last) - found.waypoints->leftCols(last))
                  .colwise()
                  .norm()
                  .maxCoeff(),
              kStep + 1e-9);
  }
  EXPECT_GT(solved, 0) << "else nothing was compared";
}

/// The hand stays nearly level from before the shelf until it is within.
TEST_P(Recalls, UnderAConstraintTheWholePathKeepsIt) {
  ShelfCell level;
  const auto front = planning::goal_configurations(
      level.chain,
      Eigen::Translation3d(0.38, 0, 0.5) *
          Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()),
      planning::planning_bounds(level.chain, level.start), [](const auto&) { return true; });
  ASSERT_GT(front.configurations.cols(), 0);
  level.start = front.configurations.col(0);
  TaskSpaceRegion region;
  region.T_region_end.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));
  region.bounds.row(1) << 9, 9, 9, 0.02, 0.02, 0.5;  // a warp alone leaves it
  region.bounds.row(0) = -region.bounds.row(1);
  const auto constrained = [&](std::uint64_t first, std::uint64_t count) {
    std::vector<PosedQuery> queries = level.queries(first, count);
    for (PosedQuery& query : queries)
      query.constraint = region;
    return queries;
  };
  RecallLibrary library = level.make(constrained(0, 8)).value();
  library.search_checks = 1e6;
  const RecallGuide guide(level.chain, library);
  int solved = 0;
  for (const PosedQuery& posed : constrained(100, 8)) {
    Query query = asked(level, library, posed, GetParam());
    planning::RegionConstraint constraint(level.chain, region, posed.surroundings.T_task_base,
                                          posed.bounds);
    query.constraint = &constraint;
    collision::CollisionWorld world(level.solids, posed.surroundings);
    const RecallSummary found = recall(guide, query, planning::free_in(world), kOptions);
    if (!found.waypoints)
      continue;
    ++solved;
    EXPECT_GT(constraint.projections(), 0U);
    const Eigen::MatrixXd& path = *found.waypoints;
    EXPECT_EQ(path.col(0), query.start);
    for (Eigen::Index i = 0; i < path.cols(); ++i) {
      EXPECT_LE(constraint.distance(path.col(i)), planning::RegionConstraint::kWaypointTolerance);
      EXPECT_FALSE(world.collides(path.col(i)));
      if (i == 0)
        continue;
      EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), kStep + 1e-9);
      EXPECT_LE(constraint.distance((path.col(i) + path.col(i - 1)) / 2),
                planning::RegionConstraint::kBetweenTolerance);
    }
  }
  EXPECT_GT(solved, 0) << "else nothing was compared";
}

TEST_P(Recalls, AStraightLineTellsNothingOfThePaths) {
  int straight = 0;
  for (Fresh& each : fresh()) {
    const RecallSummary found =
        recall(guide_, each.query, planning::IsFree([](const auto&) { return true; }), kOptions);
    EXPECT_EQ(found.expected, 0);
    straight += found.is_straight_line ? 1 : 0;
  }
  EXPECT_GT(straight, 0);
}

TEST_P(Recalls, EachConfigurationOfThePathWasAsked) {
  int solved = 0;
  for (Fresh& each : fresh()) {
    std::vector<Eigen::VectorXd> asked;
    const planning::IsFree is_free([&](const Eigen::VectorXd& q) {
      asked.push_back(q);
      return !each.world.collides(q);
    });
    const RecallSummary found = recall(guide_, each.query, is_free, kOptions);
    EXPECT_EQ(found.collision_checks, asked.size());
    if (!found.waypoints)
      continue;
    ++solved;
    for (const auto& q : found.waypoints->colwise())
      EXPECT_TRUE(std::ranges::find(asked, Eigen::VectorXd(q)) != asked.end());
  }
  EXPECT_GT(solved, 0) << "else nothing was returned";
}

TEST_P(Recalls, AGoalThatCollidesIsNotReached) {
  for (Fresh& each : fresh()) {
    const planning::IsFree is_free([&](const Eigen::VectorXd& q) {
      return GetParam() ? !inverse::reaches(made_shelf().cell.chain, each.query.T_base_goal, q)
                        : (each.query.goals.colwise() - q).colwise().norm().minCoeff() > 0;
    });
    EXPECT_FALSE(recall(guide_, each.query, is_free, kOptions).waypoints);
  }
}

TEST_P(Recalls, EqualArgumentsGiveEqualAnswers) {
  for (Fresh& each : fresh()) {
    const planning::IsFree is_free = planning::free_in(each.world);
    const RecallSummary one = recall(guide_, each.query, is_free, kOptions);
    const RecallSummary other = recall(guide_, each.query, is_free, kOptions);
    EXPECT_EQ(one.waypoints, other.waypoints);
    EXPECT_EQ(one.collision_checks, other.collision_checks);
    EXPECT_EQ(one.tries, other.tries);
  }
}

TEST_P(Recalls, WithAProverThePathIsProven) {
  int solved = 0;
  for (Fresh& each : fresh()) {
    constexpr collision::EdgeProofOptions kProof{.clearance_m = 1e-3};
    collision::EdgeProver prover(each.world);
    const planning::IsFree is_free = planning::proven_in(prover, kProof);
    const RecallSummary found = recall(guide_, each.query, is_free, kOptions);
    if (!found.waypoints)
      continue;
    ++solved;
    expect_ends(each.query, *found.waypoints);
    collision::CollisionWorld again(made_shelf().cell.solids, each.posed.surroundings);
    collision::EdgeProver other(again);
    EXPECT_TRUE(planning::proven_in(other, kProof).way_is_free(*found.waypoints));
  }
  EXPECT_GT(solved, 0) << "else nothing was proven";
}

TEST_P(Recalls, ALineThatIsRefutedIsNotReturned) {
  for (Fresh& each : fresh()) {
    const planning::IsFree nothing_proven =
        planning::free_in(each.world).with_edges([](const auto& from, const auto&) {
          return planning::IsFree::Lines(static_cast<std::size_t>(from.cols()));
        });
    EXPECT_FALSE(recall(guide_, each.query, nothing_proven, kOptions).waypoints);
  }
}

/// What blocks a path is on it alone; the search has another goal, and no other track.
TEST_P(Recalls, ASearchFollowsAPathThatFailed) {
  constexpr double kBlocked = 0.2;  // joint units
  RecallOptions once = kOptions;
  once.most_spent = 0;
  int ended = 0;
  for (Fresh& each : fresh()) {
    RecallSummary found = recall(guide_, each.query, planning::free_in(each.world), once);
    if (!found.waypoints || found.is_straight_line)
      continue;
    const Eigen::VectorXd middle = found.waypoints->col(found.waypoints->cols() / 2);
    const Eigen::VectorXd goal = found.waypoints->rightCols<1>();
    const planning::IsFree is_free([&](const Eigen::VectorXd& q) {
      return (q - middle).norm() > kBlocked && !each.world.collides(q);
    });
    found = recall(guide_, each.query, is_free, once);
    ASSERT_EQ(found.failed.size(), 1U);
    EXPECT_EQ(whole(found.failed)[0].col(0), each.query.start);
    EXPECT_EQ(whole(found.failed)[0].rightCols<1>(), goal);
    Eigen::Index farthest = 0;
    (each.posed.goals.colwise() - goal).colwise().norm().maxCoeff(&farthest);
    const Eigen::VectorXd other = each.posed.goals.col(farthest);
    const auto sampler = planning::guided_sampler(made_shelf().cell.chain,
                                                  {each.query.T_task_base,
                                                   each.query.bounds,
                                                   each.query.start,
                                                   other,
                                                   {},
                                                   [&] { return whole(found.failed); }},
                                                  nullptr,
                                                  std::make_shared<const planning::ExperienceGuide>(
                                                      made_shelf().cell.chain, TaskExperience{}),
                                                  {.guide = Guide::Ways})
                             .sampler;
    std::mt19937_64 generator(1);
    const planning::PlanSummary plan =
        planning::plan_birrt(each.query.start, other, is_free, sampler, {.step = kStep}, generator);
    ASSERT_TRUE(plan.waypoints);
    EXPECT_EQ(plan.tracks_followed, plan.found_by == FoundBy::StraightLine ? 0U : 1U);
    for (const auto& q : plan.waypoints->colwise())
      EXPECT_TRUE(is_free(q));
    const Eigen::VectorXd end = plan.waypoints->rightCols<1>();
    EXPECT_TRUE(end == goal || end == other);
    ended += end == goal && goal != other ? 1 : 0;
  }
  EXPECT_GT(ended, 0) << "else none was of use";
}

TEST_P(Recalls, AStartThatCollidesCostsOneCheck) {
  for (Fresh& each : fresh()) {
    const planning::IsFree is_free([&](const Eigen::VectorXd& q) { return q != each.query.start; });
    const RecallSummary found = recall(guide_, each.query, is_free, kOptions);
    EXPECT_FALSE(found.waypoints);
    EXPECT_LE(found.collision_checks, 1U);
    EXPECT_EQ(found.tries, 0U);
    EXPECT_EQ(found.expected, 0);
  }
}

TEST_P(Recalls, WhereNothingIsFreeTriesEnd) {
  RecallLibrary library = made_shelf().library;
  library.search_checks = 1000;
  library.try_checks = 10;
  const RecallGuide guide(made_shelf().cell.chain, library);
  for (Fresh& each : fresh()) {
    const planning::IsFree is_free([&](const Eigen::VectorXd& q) { return q == each.query.start; });
    RecallOptions options = kOptions;
    options.most_spent = 0.1;
    const RecallSummary found = recall(guide, each.query, is_free, options);
    EXPECT_FALSE(found.waypoints);
    EXPECT_LE(found.tries, 11U) << "of ten checks each, a tenth of a search";
    options.trust = 0;
    EXPECT_EQ(recall(guide, each.query, is_free, options).collision_checks, 0U);
  }
}

TEST_P(Recalls, NoneIsMadeAlongAWallThatAllRunInto) {
  for (Fresh& each : fresh()) {
    each.posed.surroundings.scene.objects.push_back(
        {"door", BoxShape{{0.02, 0.7, 0.5}},
         each.posed.surroundings.scene.objects[0].T_task_object *
             Eigen::Translation3d(-0.16, 0, 0.18)});
    collision::CollisionWorld closed(made_shelf().cell.solids, each.posed.surroundings);
    EXPECT_FALSE(recall(guide_, each.query, planning::free_in(closed), kOptions).waypoints);
  }
}

INSTANTIATE_TEST_SUITE_P(ToGoalsAndToAPose, Recalls, testing::Bool());

}  // namespace
}  // namespace kinship::recall::recall_test
