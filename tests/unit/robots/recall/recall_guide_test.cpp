#include "robots/recall/recall_guide.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <tuple>

#include "robots/inverse/descent.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::recall::recall_guide_test {
namespace {

using test_support::asked;
using test_support::kStep;
using test_support::made_shelf;
using test_support::MadeShelf;
using test_support::report_of;
using test_support::ShelfCell;

/// All candidates of a query, none of which works.
std::vector<Candidate> all_candidates(const RecallGuide& guide, const Query& query) {
  Ranking ranking(guide, query, 1);
  std::vector<Candidate> found;
  while (const auto candidate = ranking.next(kStep)) {
    EXPECT_GT(ranking.chance(), 0);
    EXPECT_LE(ranking.chance(), 1);
    found.push_back(*candidate);
    ranking.fail();
  }
  return found;
}

/// A library in which each candidate is worth a try.
RecallLibrary hopeful(RecallLibrary library) {
  library.search_checks = 1e9;
  library.try_checks = 1e-9;
  return library;
}

TEST(Ranking, AGoalThatIsNotFreeIsNotTriedAgain) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, hopeful(made.library));
  ASSERT_GT(made.library.modes.size(), 1U) << "else a path has one candidate anyhow";
  const PosedQuery posed = made.cell.queries(100, 1).front();
  std::vector<std::size_t> paths;
  Ranking by_pose(guide, asked(made.cell, made.library, posed, true), 1);
  while (const auto candidate = by_pose.next(kStep)) {
    paths.push_back(candidate->path);
    by_pose.fail_at_goal();
  }
  EXPECT_GT(paths.size(), 1U);
  std::ranges::sort(paths);
  EXPECT_TRUE(std::ranges::adjacent_find(paths) == paths.end()) << "its modes end alike";

  std::vector<Eigen::Index> goals;
  Ranking by_goal(guide, asked(made.cell, made.library, posed, false), 1);
  while (const auto candidate = by_goal.next(kStep)) {
    goals.push_back(candidate->goal);
    by_goal.fail_at_goal();
  }
  std::ranges::sort(goals);
  EXPECT_TRUE(std::ranges::adjacent_find(goals) == goals.end());
}

TEST(RecallGuide, ALibraryOfAnotherNumberOfJointsIsRefused) {
  EXPECT_THROW(RecallGuide(test::model_chain("ur10e"), made_shelf().library),
               std::invalid_argument);
}

TEST(RecallGuide, AnchorsAreFoundByTheirNames) {
  const auto objects = ShelfCell::shelf(ShelfCell::T_task_shelf(3)).scene.objects;
  const auto found = find_anchors({"top", "lamp"}, objects);
  ASSERT_EQ(found.size(), 2U);
  ASSERT_TRUE(found[0]);
  EXPECT_EQ(found[0]->matrix(), objects[1].T_task_object.matrix());
  EXPECT_FALSE(found[1]);
}

TEST(RecallGuide, WhereAllIsAsItWasAPathIsItself) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, made.library);
  for (std::size_t path = 0; path < made.library.paths.size(); ++path) {
    const RecallQuery& solved = made.library.queries[made.library.paths[path].query];
    Query query;
    query.T_task_base = solved.T_task_base;
    query.bounds = planning::planning_bounds(made.cell.chain, solved.start);
    query.start = solved.start;
    query.goals = made.library.paths[path].waypoints.rightCols<1>();
    query.T_task_anchors.assign(solved.T_task_anchors.begin(), solved.T_task_anchors.end());
    for (std::size_t mode = 0; mode < made.library.modes.size(); ++mode) {
      auto warp = guide.warp(query, {path, mode, 0});
      ASSERT_TRUE(warp);
      warp->compute(1);
      EXPECT_LT((warp->waypoints() - made.library.paths[path].waypoints).cwiseAbs().maxCoeff(),
                1e-5);
    }
  }
}

/// Base, furniture and goal move together: nothing has changed for the robot.
TEST(RecallGuide, WhatMovesWithTheBaseChangesNothing) {
  const MadeShelf& made = made_shelf();
  ASSERT_FALSE(made.library.anchors.empty());
  const RecallGuide guide(made.cell.chain, made.library);
  const Eigen::Isometry3d moved(Eigen::Translation3d(1, -2, 0.1) *
                                Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ()));
  Query here = asked(made.cell, made.library, made.recorded[1], false), there = here;
  there.T_task_base = moved * here.T_task_base;
  for (auto& T_task_anchor : there.T_task_anchors)
    T_task_anchor = moved * *T_task_anchor;
  int compared = 0;
  for (std::size_t path = 0; path < made.library.paths.size(); ++path)
    for (std::size_t mode = 0; mode < made.library.modes.size(); ++mode) {
      if (made.library.modes[mode].frame == kTaskFrame)
        continue;  // that did not move
      auto one = guide.warp(here, {path, mode, 0}), other = guide.warp(there, {path, mode, 0});
      ASSERT_TRUE(one && other);
      one->compute(1);
      other->compute(1);
      EXPECT_LT((one->waypoints() - other->waypoints()).cwiseAbs().maxCoeff(), 1e-6);
      ++compared;
    }
  EXPECT_GT(compared, 0);
}

TEST(RecallGuide, AtAPoseAPathEndsThere) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, made.library);
  int ended = 0;
  for (const PosedQuery& posed : made.recorded) {
    const Query query = asked(made.cell, made.library, posed, true);
    for (std::size_t path = 0; path < made.library.paths.size(); ++path)
      if (const auto warp = guide.warp(query, {path, 0, -1})) {
        EXPECT_TRUE(
            inverse::reaches(made.cell.chain, query.T_base_goal, warp->waypoints().rightCols<1>()));
        ++ended;
      }
  }
  EXPECT_GT(ended, 0);
}

TEST(RecallGuide, WithoutItsFrameAPathIsNotMoved) {
  const MadeShelf& made = made_shelf();
  RecallLibrary library = hopeful(made.library);
  const RecallGuide guide(made.cell.chain, library);
  Query query = asked(made.cell, library, made.recorded[0], false);
  query.T_task_anchors.assign(library.anchors.size(), std::nullopt);
  for (std::size_t mode = 0; mode < library.modes.size(); ++mode)
    EXPECT_EQ(guide.warp(query, {0, mode, 0}).has_value(),
              library.modes[mode].frame < kFirstAnchor);
  for (const Candidate& candidate : all_candidates(guide, query))
    EXPECT_LT(library.modes[candidate.mode].frame, kFirstAnchor);
}

TEST(Ranking, NoCandidateIsTriedTwice) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, hopeful(made.library));
  for (const bool is_pose : {false, true}) {
    const auto found =
        all_candidates(guide, asked(made.cell, made.library, made.recorded[0], is_pose));
    EXPECT_GT(found.size(), 1U);
    std::set<std::tuple<std::size_t, std::size_t, Eigen::Index>> different;
    for (const Candidate& each : found)
      different.insert({each.path, each.mode, each.goal});
    EXPECT_EQ(different.size(), found.size());
  }
}

TEST(Ranking, APlannedAgainQueryIsNotHelpedByItsOwnPaths) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, hopeful(made.library));
  const auto helps = [&](const Query& query, const Uuid& report) {
    return std::ranges::any_of(all_candidates(guide, query), [&](const Candidate& candidate) {
      return made.library.queries[made.library.paths[candidate.path].query].report == report;
    });
  };
  int own = 0;
  for (const PosedQuery& posed : made.recorded)
    for (const bool is_pose : {false, true}) {
      Query query = asked(made.cell, made.library, posed, is_pose);
      own += helps(query, posed.report) ? 1 : 0;
      query.without = posed.report;
      EXPECT_FALSE(helps(query, posed.report));
    }
  EXPECT_GT(own, 0) << "else nothing was left out";
}

TEST(Ranking, WithoutTrustThereIsNoCandidate) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, hopeful(made.library));
  const Query query = asked(made.cell, made.library, made.recorded[0], false);
  EXPECT_TRUE(Ranking(guide, query, 1).next(kStep));
  EXPECT_FALSE(Ranking(guide, query, 0).next(kStep));
}

TEST(Ranking, ChancesGoWithTrust) {
  const MadeShelf& made = made_shelf();
  const RecallGuide guide(made.cell.chain, hopeful(made.library));
  const Query query = asked(made.cell, made.library, made.recorded[0], false);
  Ranking trusted(guide, query, 1), doubted(guide, query, 0.5);
  ASSERT_TRUE(trusted.next(kStep) && doubted.next(kStep));
  EXPECT_LT(doubted.chance(), trusted.chance());
}

TEST(Ranking, WhereASearchIsCheaperNothingIsTried) {
  const MadeShelf& made = made_shelf();
  RecallLibrary cheap = made.library;
  cheap.search_checks = 1;
  const RecallGuide guide(made.cell.chain, cheap);
  EXPECT_FALSE(Ranking(guide, asked(made.cell, cheap, made.recorded[0], false), 1).next(kStep));
}

/// Six equal queries with equal paths; what each path is said to solve of the others is all that
/// tells them apart.
class EqualQueries : public testing::Test {
 protected:
  EqualQueries() {
    library_.revision = 1;
    library_ = hopeful(std::move(library_));
    library_.try_checks = 40;
    library_.modes = {{0, kTaskFrame}};
    query_.start = Eigen::Vector2d(0, 0);
    query_.goals = Eigen::Vector2d(1, 1);
    query_.bounds = planning::planning_bounds(chain_, query_.start);
    for (std::uint64_t i = 0; i < 6; ++i) {
      RecallQuery& query = library_.queries.emplace_back();
      query.report = report_of(i);
      query.start = query_.start;
      query.goal = query_.goals;
    }
  }

  /// A path of the next query, from the fourth on.
  void add_path(std::vector<std::size_t> solves) {
    Eigen::MatrixXd line(2, 2);
    line << 0, 1, 0, 1;
    const auto query = static_cast<std::uint32_t>(3 + library_.paths.size());
    library_.paths.push_back({query, planning::densified(line, line.norm() / 31 - 1e-9)});
    library_.paths.back().waypoints.conservativeResize(2, kRecallWaypoints);
    library_.paths.back().waypoints.rightCols<1>() = line.col(1);
    solved_.push_back(std::move(solves));
  }

  /// The order of paths as all of them fail.
  std::vector<std::size_t> order() {
    const std::size_t bits = library_.queries.size() * library_.paths.size();
    library_.solves.assign((bits + 7) / 8, 0);
    for (std::size_t path = 0; path < solved_.size(); ++path)
      for (const std::size_t query : solved_[path]) {
        const std::size_t bit = library_.bit(query, path, 0);
        library_.solves[bit / 8] =
            static_cast<std::uint8_t>(library_.solves[bit / 8] | 1U << (bit % 8));
      }
    library_.reaches = library_.solves;
    EXPECT_FALSE(validate(library_));
    std::vector<std::size_t> paths;
    for (const Candidate& candidate : all_candidates(RecallGuide(chain_, library_), query_))
      paths.push_back(candidate.path);
    return paths;
  }

  const kinematics::Chain chain_ = test::PlanarArm{{0.4, 0.3}, 3}.chain();
  RecallLibrary library_;
  std::vector<std::vector<std::size_t>> solved_;
  Query query_;
};

TEST_F(EqualQueries, WhatSolvedMoreOfThemIsTriedFirst) {
  add_path({0});
  add_path({0, 1, 2});
  add_path({0, 1});
  EXPECT_EQ(order(), (std::vector<std::size_t>{1, 2, 0}));
}

TEST_F(EqualQueries, AfterAFailureThoseThatSolvedTheSameRankLower) {
  add_path({0, 1});
  add_path({0, 1});
  add_path({2});
  const std::vector<std::size_t> found = order();
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NE(found[0], 2U) << "it solved fewer";
  EXPECT_EQ(found[1], 2U) << "what is like the first will fail like it";
}

}  // namespace
}  // namespace kinship::recall::recall_guide_test
