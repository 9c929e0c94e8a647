#include <gtest/gtest.h>

#include "proto/json/problem_json.hpp"

namespace kinship::json::recorded_search_json_test {
namespace {

RecordedSearch small_search() {
  RecordedSearch search{"shelf 7", Eigen::MatrixXd(2, 3), {-1, -1, 0}, {1, 2, 30}, {0, 2, 1}};
  search.nodes << 0.1, 0.2, 0.3, 1.1, 1.2, 1.3;
  return search;
}

std::string message_of(const RecordedSearch& search) {
  const auto read = recorded_search_from_json(to_json(search));
  return read ? "accepted" : read.error().message;
}

TEST(RecordedSearchJson, IsWhatItWas) {
  const RecordedSearch search = small_search();
  const auto back = recorded_search_from_json(to_json(search));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, search.name);
  EXPECT_EQ(back->nodes, search.nodes);
  EXPECT_EQ(back->parents, search.parents);
  EXPECT_EQ(back->checks, search.checks);
  EXPECT_EQ(back->path, search.path);
}

TEST(RecordedSearchJson, ASearchThatWasNotRecordedIsEmpty) {
  const auto back = recorded_search_from_json(to_json(RecordedSearch{"ompl", {}, {}, {}, {}}));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->nodes.cols(), 0);
}

TEST(RecordedSearchJson, WhatIsNoTreeIsRefused) {
  RecordedSearch search = small_search();
  search.parents[2] = 2;
  EXPECT_NE(message_of(search).find("parents[2]: must be -1 or an earlier node, is 2"),
            std::string::npos)
      << message_of(search);
  search = small_search();
  search.path = {0, 3};
  EXPECT_NE(message_of(search).find("path[1]: must be one of 3 nodes"), std::string::npos)
      << message_of(search);
  search = small_search();
  search.checks.pop_back();
  EXPECT_NE(message_of(search).find("3 nodes, 3 parents and 2 checks"), std::string::npos);
}

}  // namespace
}  // namespace kinship::json::recorded_search_json_test
