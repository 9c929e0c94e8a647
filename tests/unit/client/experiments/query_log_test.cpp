#include "client/experiments/pipeline/query_log.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "client/experiments/pipeline/compressed_file.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::experiments::query_log_test {
namespace {

Digest digest_of(std::uint8_t byte) {
  Digest digest;
  digest.bytes.fill(byte);
  return digest;
}

QueryResult result_of(const std::string& instance, std::optional<Digest> distribution) {
  return {.key = {"arm", distribution ? "panda" : "uniform", instance, 1},
          .distribution = distribution,
          .solved = true,
          .checks = 1234,
          .goal_checks = 20,
          .projections = 7,
          .cpu_s = 0.1 + 0.2,
          .length = 12.25};
}

class QueryLogs : public testing::Test {
 protected:
  std::string text() const {
    std::ifstream stream(file_);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "test.jsonl";
};

TEST_F(QueryLogs, AnInterruptedRunGoesOnWhereItWas) {
  const QueryResult first = result_of("a", std::nullopt), second = result_of("b", digest_of(1));
  {
    QueryLog log(file_);
    log.add(first);
    log.add(second);
  }
  std::ofstream(file_, std::ios::app) << R"({"robot": "arm", "guid)";  // killed while writing
  QueryLog log(file_);
  EXPECT_TRUE(log.has(first.key, std::nullopt));
  EXPECT_TRUE(log.has(second.key, digest_of(1)));
  ASSERT_EQ(log.results().size(), 2U);
  EXPECT_EQ(to_json(log.results()[1]), to_json(first));  // by key: panda before uniform
  log.add(result_of("c", std::nullopt));
  EXPECT_EQ(read_query_results(file_).size(), 3U);
}

TEST_F(QueryLogs, RowsSayWhatTheGateDidAndOlderOnesStayAsTheyAre) {
  QueryResult gated = result_of("a", digest_of(1));
  gated.gate_fired = true;
  gated.guided_share = 0.25;
  const QueryResult older = result_of("b", digest_of(1));
  {
    QueryLog log(file_);
    log.add(gated);
    log.add(older);
  }
  const std::vector<QueryResult> read = read_query_results(file_);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].gate_fired, true);
  EXPECT_EQ(read[0].guided_share, 0.25);
  EXPECT_EQ(read[1].gate_fired, std::nullopt);
  EXPECT_EQ(read[1].guided_share, std::nullopt);
  EXPECT_EQ(to_json(read[1]).find("gate_fired"), std::string::npos);
}

TEST_F(QueryLogs, ResultsOfAnotherDistributionAreNotTakenForThese) {
  QueryLog log(file_);
  log.add(result_of("a", digest_of(1)));
  EXPECT_THROW(log.has(result_of("a", digest_of(1)).key, digest_of(2)), Failure);
}

TEST_F(QueryLogs, WhatIsNoResultIsNotOverwritten) {
  std::ofstream(file_) << "notes\n" << to_json(result_of("a", std::nullopt)) << '\n';
  EXPECT_THROW(QueryLog{file_}, Failure);
  EXPECT_TRUE(text().starts_with("notes"));
}

TEST_F(QueryLogs, GoesOnFromTheCompressedTwin) {
  {
    QueryLog log(file_);
    log.add(result_of("a", std::nullopt));
  }
  const std::string before = text();
  compress_file(file_);
  std::filesystem::remove(file_);
  EXPECT_EQ(read_query_results(file_).size(), 1U);
  EXPECT_EQ(text(), before);
}

TEST_F(QueryLogs, ADamagedTwinIsRefused) {
  {
    QueryLog log(file_);
    log.add(result_of("a", std::nullopt));
  }
  compress_file(file_);
  std::filesystem::remove(file_);
  std::fstream twin(compressed_name(file_), std::ios::in | std::ios::out | std::ios::binary);
  twin.seekp(20);
  twin.put('\x7f').put('\x7f').put('\x7f');
  twin.close();
  EXPECT_THROW(QueryLog{file_}, Failure);
  std::ofstream(compressed_name(file_)) << "no zstd";
  EXPECT_THROW(QueryLog{file_}, Failure);
}

TEST(QueryResults, ALineWithoutAMemberIsRefused) {
  EXPECT_FALSE(query_result_from_json(R"({"robot": "arm"})"));
  EXPECT_FALSE(query_result_from_json("[]"));
  EXPECT_FALSE(query_result_from_json(""));
}

}  // namespace
}  // namespace kinship::experiments::query_log_test
