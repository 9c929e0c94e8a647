#include <gtest/gtest.h>

#include "proto/codec/report_codec.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::search_codec_test {
namespace {

Attempt failed_attempt() {
  test::RandomValues values(34);
  Attempt attempt = values.attempt();
  attempt.record.outcome = Outcome::Failed;
  attempt.path.reset();
  SearchRecord& search = attempt.search.emplace();
  search.start = Eigen::Vector2d(0.1, 0.2);
  search.goals = Eigen::MatrixXd::Ones(2, 3);
  search.blockers = {{"l4", "wall", 60}};
  search.trees = {{Eigen::MatrixXf::Zero(2, 2), {-1, 0}}};
  return attempt;
}

TEST(SearchCodec, ABadRecordIsRefusedByName) {
  auto message = encode({}, ReportRequest{{failed_attempt()}, {}}).value_or_throw();
  kinship_wire_SearchRecord& wire = message.wire.attempts._buffer[0].search._buffer[0];
  const auto complaint = [&message] { return decode(message.wire)->refused.at(0).message; };
  EXPECT_EQ(decode(message.wire)->attempts.size(), 1U);
  wire.dof = 4;
  EXPECT_EQ(complaint(), "search: start: has 2 joints, not 4");
  wire.dof = 4'000'000'000U;
  EXPECT_EQ(complaint(), "search: joints: 4000000000 exceeds 32");
  wire.dof = 2;
  wire.goals._length = 5;
  EXPECT_EQ(complaint(), "search: goals: 5 numbers are no multiple of dof 2");
  wire.goals._length = 6;
  wire.trees._buffer[0].parents._buffer[1] = 1;
  EXPECT_EQ(complaint(), "search: a tree's parent is neither -1 nor earlier");
  wire.trees._buffer[0].parents._buffer[1] = 0;
  wire.blockers._buffer[0].first = nullptr;
  EXPECT_EQ(complaint(), "search: blockers: a name: is empty");
}

TEST(SearchCodec, WhatAnOlderPeerLacksIsMissing) {
  auto message = encode({}, ReportRequest{{failed_attempt()}, {}}).value_or_throw();
  kinship_wire_Attempt& wire = message.wire.attempts._buffer[0];
  wire.search._buffer[0].trees._buffer = nullptr;
  wire.search._buffer[0].reason = nullptr;
  EXPECT_TRUE(decode(message.wire)->attempts.at(0).search->trees.empty());
  wire.search._buffer = nullptr;
  EXPECT_FALSE(decode(message.wire)->attempts.at(0).search);
}

TEST(SearchCodec, RecordsOfABatchAreLimitedWithItsWaypoints) {
  Attempt attempt = failed_attempt();
  SearchTree& tree = attempt.search->trees[0];
  tree.configurations = Eigen::MatrixXf::Zero(2, 10'000);
  tree.parents.assign(10'000, -1);
  ReportRequest request{{attempt, attempt, attempt, attempt}, {}};
  EXPECT_TRUE(encode({}, request));
  request.attempts.push_back(attempt);
  EXPECT_EQ(encode({}, request).error().message,
            "waypoints and searches of a batch (bytes): " +
                std::to_string(5 * search_bytes(*attempt.search)) + " exceeds 524288");
}

}  // namespace
}  // namespace kinship::codec::search_codec_test
