#include "robots/recall/library_maker.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/recall/recall.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::recall::library_maker_test {
namespace {

using test_support::asked;
using test_support::kStep;
using test_support::made_shelf;
using test_support::MadeShelf;

TEST(LibraryMaker, KeepsTheRulesOfALibrary) {
  const RecallLibrary& library = made_shelf().library;
  const auto error = validate(library);
  EXPECT_FALSE(error) << error->message;
  EXPECT_EQ(library.queries.size(), made_shelf().recorded.size());
  EXPECT_FALSE(library.paths.empty());
  EXPECT_GT(library.search_checks, 0);
  EXPECT_EQ(library.anchors, std::vector<std::string>{"bottom"}) << "the shelf moves as one";
}

TEST(LibraryMaker, PathsLeadFromTheirQuerysStartToItsGoalsPose) {
  const MadeShelf& made = made_shelf();
  for (const RecallPath& path : made.library.paths) {
    const RecallQuery& query = made.library.queries[path.query];
    EXPECT_EQ(path.waypoints.col(0), query.start);
    const Eigen::Isometry3d wanted = kinematics::T_base_transfer(made.cell.chain, query.goal);
    EXPECT_TRUE(kinematics::T_base_transfer(made.cell.chain, path.waypoints.rightCols<1>())
                    .isApprox(wanted, 1e-4));
  }
}

TEST(LibraryMaker, EqualQueriesGiveAnEqualLibrary) {
  const MadeShelf& made = made_shelf();
  const RecallLibrary again = made.cell.make(made.recorded).value();
  const RecallLibrary& library = made.library;
  EXPECT_EQ(again.revision, library.revision);
  EXPECT_EQ(again.search_checks, library.search_checks);
  EXPECT_EQ(again.anchors, library.anchors);
  EXPECT_EQ(again.modes, library.modes);
  EXPECT_EQ(again.solves, library.solves);
  EXPECT_EQ(again.reaches, library.reaches);
  ASSERT_EQ(again.paths.size(), library.paths.size());
  for (std::size_t i = 0; i < library.paths.size(); ++i) {
    EXPECT_EQ(again.paths[i].query, library.paths[i].query);
    EXPECT_EQ(again.paths[i].waypoints, library.paths[i].waypoints);
  }
  ASSERT_EQ(again.queries.size(), library.queries.size());
  for (std::size_t i = 0; i < library.queries.size(); ++i)
    EXPECT_EQ(again.queries[i].goal, library.queries[i].goal);
}

TEST(LibraryMaker, OtherQueriesGiveAnotherRevision) {
  const MadeShelf& made = made_shelf();
  std::vector<PosedQuery> fewer = made.recorded;
  fewer.pop_back();
  EXPECT_NE(made.cell.make(fewer)->revision, made.library.revision);
}

/// What the bits promise is so, asked again; and none promises that a path helps its own query.
TEST(LibraryMaker, APathThatSolvesAQueryIsFreeThere) {
  const MadeShelf& made = made_shelf();
  const RecallLibrary& library = made.library;
  const RecallGuide guide(made.cell.chain, library);
  int solved = 0;
  for (std::size_t query = 0; query < library.queries.size(); ++query) {
    collision::CollisionWorld world(made.cell.solids, made.recorded[query].surroundings);
    const planning::IsFree is_free = planning::free_in(world);
    Query to_goal = asked(made.cell, library, made.recorded[query], false), to_pose = to_goal;
    to_goal.goals = library.queries[query].goal;
    to_pose.goals.resize(made.cell.chain.dof(), 0);
    to_pose.T_base_goal = kinematics::T_base_transfer(made.cell.chain, library.queries[query].goal);
    for (std::size_t path = 0; path < library.paths.size(); ++path)
      for (std::size_t mode = 0; mode < library.modes.size(); ++mode) {
        const std::size_t bit = library.bit(query, path, mode);
        const bool is_own = library.paths[path].query == query;
        const auto works = [&](const Query& asked_for, Eigen::Index goal) {
          auto warp = guide.warp(asked_for, {path, mode, goal});
          RecallSummary summary;
          return warp && is_goal_free(*warp, is_free, summary) &&
                 is_way_free(*warp, is_free, kStep, summary);
        };
        EXPECT_EQ(bit_of(library.solves, bit), !is_own && works(to_goal, 0));
        EXPECT_EQ(bit_of(library.reaches, bit), !is_own && works(to_pose, -1));
        solved += bit_of(library.solves, bit) ? 1 : 0;
      }
  }
  EXPECT_GT(solved, 0);
}

TEST(LibraryMaker, AReportsPathsJudgeNoQueryOfIt) {
  const MadeShelf& made = made_shelf();
  std::vector<PosedQuery> twice = made.recorded;
  for (PosedQuery query : made.recorded) {
    query.start[0] += 0.1;
    twice.push_back(std::move(query));
  }
  const RecallLibrary library = made.cell.make(twice).value();
  ASSERT_GT(library.queries.size(), made.recorded.size());
  for (std::size_t query = 0; query < library.queries.size(); ++query)
    for (std::size_t path = 0; path < library.paths.size(); ++path)
      for (std::size_t mode = 0; mode < library.modes.size(); ++mode) {
        const std::size_t bit = library.bit(query, path, mode);
        EXPECT_FALSE(library.queries[library.paths[path].query].report ==
                         library.queries[query].report &&
                     (bit_of(library.solves, bit) || bit_of(library.reaches, bit)));
      }
}

TEST(LibraryMaker, EachPathSolvesAnotherQuery) {
  const RecallLibrary& library = made_shelf().library;
  for (std::size_t path = 0; path < library.paths.size(); ++path) {
    bool is_useful = false;
    for (std::size_t query = 0; query < library.queries.size(); ++query)
      for (std::size_t mode = 0; mode < library.modes.size(); ++mode) {
        const std::size_t bit = library.bit(query, path, mode);
        is_useful = is_useful || bit_of(library.solves, bit) || bit_of(library.reaches, bit);
      }
    EXPECT_TRUE(is_useful) << path;
  }
}

TEST(LibraryMaker, QueriesOfTooFewReportsLeaveNothingOut) {
  const MadeShelf& made = made_shelf();
  for (const std::size_t times : {1, 4}) {
    const auto library = made.cell.make(std::vector<PosedQuery>(times, made.recorded.front()));
    ASSERT_TRUE(library);
    EXPECT_FALSE(validate(*library));
    EXPECT_EQ(library->queries.size(), times);
    EXPECT_FALSE(library->paths.empty());
  }
}

TEST(LibraryMaker, OwnAnswersAreKeptAndPlannedOnesAreSynthetic) {
  const MadeShelf& made = made_shelf();
  std::vector<PosedQuery> queries = made.recorded;
  Eigen::MatrixXd own(7, 2);
  own << queries[1].start, queries[1].goals.col(0);
  queries[1].solution = own;
  const RecallLibrary library = made.cell.make(queries).value();
  for (const RecallQuery& query : library.queries) {
    const bool is_own = query.report == queries[1].report;
    EXPECT_EQ(query.is_synthetic, !is_own);
    EXPECT_TRUE(!is_own || query.goal == own.col(1));
  }
  for (const RecallQuery& query : made.library.queries)
    EXPECT_TRUE(query.is_synthetic);
}

TEST(LibraryMaker, MostPathsAreALimit) {
  LibraryMakerOptions options;
  options.max_paths = 3;
  const auto few = made_shelf().cell.make(made_shelf().recorded, options);
  ASSERT_TRUE(few);
  EXPECT_LE(few->paths.size(), 3U);
  EXPECT_FALSE(validate(*few));
}

TEST(LibraryMaker, WithoutAnAnswerThereIsNoLibrary) {
  const MadeShelf& made = made_shelf();
  EXPECT_FALSE(made.cell.make({}));
  PosedQuery closed = made.recorded.front();
  for (SceneObject& object : closed.surroundings.scene.objects)
    if (object.name == "top")  // a door
      object.T_task_object = closed.surroundings.scene.objects[0].T_task_object *
                             Eigen::Translation3d(-0.16, 0, 0.18) *
                             Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY());
  LibraryMakerOptions options;
  options.max_checks = 200;
  EXPECT_FALSE(made.cell.make({closed}, options));
}

TEST(LibraryMaker, AnExceptionBeforeACheckEndsAStep) {
  struct Enough : std::exception {};
  const MadeShelf& made = made_shelf();
  for (const int patience : {0, 200, 5000}) {
    int left = patience;
    LibraryMakerOptions options;
    options.step = kStep;
    options.before = [&left] {
      if (left-- == 0)
        throw Enough();
    };
    LibraryMaker maker(made.cell.chain, made.cell.solids, made.recorded, options);
    EXPECT_THROW(while (maker.step()){}, Enough) << patience;
    EXPECT_FALSE(maker.take()) << "it is not complete";
  }
}

TEST(LibraryMaker, BeforeTheLastStepThereIsNoLibrary) {
  const MadeShelf& made = made_shelf();
  LibraryMaker maker(made.cell.chain, made.cell.solids, made.recorded, {.step = kStep});
  std::size_t steps = 0;
  while (maker.step())
    ++steps;
  EXPECT_GE(steps, 2 * made.recorded.size()) << "a query a step";
  EXPECT_TRUE(maker.take());
  LibraryMaker begun(made.cell.chain, made.cell.solids, made.recorded, {.step = kStep});
  begun.step();
  EXPECT_FALSE(begun.take());
}

}  // namespace
}  // namespace kinship::recall::library_maker_test
