#include "proto/types/search_record.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "proto/types/attempt.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::search_record_test {
namespace {

SearchRecord record_of_two_joints() {
  SearchRecord search;
  search.start = Eigen::Vector2d(0.1, 0.2);
  search.goals = Eigen::MatrixXd::Ones(2, 3);
  search.blockers = {{"l4", "wall", 60}, {"l5", "table", 2}};
  search.goal_contacts = {{2, "l5", "wall"}};
  search.last_free = Eigen::Vector2d(0.3, 0.4);
  search.trees = {{Eigen::MatrixXf::Zero(2, 3), {-1, 0, 0}}};
  search.reason = "not solved within 10 s";
  return search;
}

std::string complaint(const SearchRecord& search) {
  const auto error = check_search(search);
  return error ? error->message : "";
}

TEST(SearchRecord, NamesTheRuleThatItBreaks) {
  const SearchRecord good = record_of_two_joints();
  EXPECT_EQ(complaint(good), "");
  EXPECT_EQ(complaint({}), "") << "everything may be missing";
  SearchRecord bad = good;
  bad.last_free.conservativeResize(3);
  EXPECT_EQ(complaint(bad), "search: start has 2 joints, not 3");
  bad = good;
  bad.goals(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint(bad), "search: a configuration has numbers that are not finite");
  bad = good;
  bad.goals = Eigen::MatrixXd::Zero(2, 65);
  EXPECT_EQ(complaint(bad), "search: goals: 65 exceeds 64");
  bad = good;
  bad.blockers.assign(33, bad.blockers[0]);
  EXPECT_EQ(complaint(bad), "search: blockers: 33 exceeds 32");
  bad = good;
  bad.blockers[1].second = "";
  EXPECT_EQ(complaint(bad), "search: blockers: a name: is empty");
  bad = good;
  bad.goal_contacts[0].goal = 3;
  EXPECT_EQ(complaint(bad), "search: goal_contacts: goal 3 of 3");
  bad = good;
  bad.trees[0].parents = {-1, 2, 0};
  EXPECT_EQ(complaint(bad), "search: a tree's parent is neither -1 nor earlier");
  bad.trees[0].parents = {-1, 0};
  EXPECT_EQ(complaint(bad), "search: a tree of 3 configurations has 2 parents");
  bad = good;
  bad.trees[0].configurations = Eigen::MatrixXf::Zero(2, 15'000);
  bad.trees[0].parents.assign(15'000, -1);
  EXPECT_EQ(complaint(bad),
            "search (bytes): " + std::to_string(search_bytes(bad)) + " exceeds 131072");
}

TEST(SearchRecord, BytesAreCountedAsTheContractSays) {
  SearchRecord search;
  EXPECT_EQ(search_bytes(search), 128U);
  search = record_of_two_joints();
  search.T_task_goal = Eigen::Isometry3d::Identity();
  const std::size_t configurations = 8 * 2 * (1 + 3 + 1), pairs = 3 * 24 + 6 + 7 + 6,
                    tree = 4 * (6 + 3);
  EXPECT_EQ(search_bytes(search), 128 + configurations + 56 + pairs + tree + search.reason.size());
}

TEST(SearchRecord, SaysWhyInFewWords) {
  SearchRecord search = record_of_two_joints();
  EXPECT_EQ(why_text(search),
            "not solved within 10 s; 'l5' touches 'wall' (1 of 3 goals), 'l4' touches 'wall' (60), "
            "'l5' touches 'table' (2); "
            "last free configuration 0.92 from a goal");
  search.reason.clear();
  EXPECT_EQ(
      why_text(search),
      "'l5' touches 'wall' (1 of 3 goals), 'l4' touches 'wall' (60), 'l5' touches 'table' (2); "
      "last free configuration 0.92 from a goal");
  EXPECT_EQ(why_text({}), "");
  search.last_free.resize(0);
  EXPECT_EQ(
      why_text(search),
      "'l5' touches 'wall' (1 of 3 goals), 'l4' touches 'wall' (60), 'l5' touches 'table' (2)");
  search.reason = "every goal collides: 'l4' touches 'wall'";
  EXPECT_EQ(why_text(search), search.reason) << "no search was begun";
  search.reason = std::string(2000, 'x');
  EXPECT_EQ(why_text(search).size(), kMaxWhyBytes);
}

TEST(SearchRecord, CountsWithWaypointsAgainstABatch) {
  test::RandomValues values(7);
  Attempt attempt = values.attempt();
  attempt.record.outcome = Outcome::Solved;
  attempt.path = Path(Eigen::MatrixXd::Zero(4, 16384));  // all that a batch may have
  EXPECT_FALSE(validate(attempt));
  attempt.search = SearchRecord{};
  EXPECT_EQ(validate(attempt)->message, "waypoints and search (bytes): 524416 exceeds 524288");
  EXPECT_FALSE(batch_bytes(attempt).fits());
  attempt.path = Path(Eigen::MatrixXd::Zero(4, 16000));
  EXPECT_FALSE(validate(attempt));
  EXPECT_TRUE(batch_bytes(attempt).fits());
  attempt.search = record_of_two_joints();
  EXPECT_EQ(validate(attempt)->message, "search: has 2 joints, the path another number");
}

}  // namespace
}  // namespace kinship::search_record_test
