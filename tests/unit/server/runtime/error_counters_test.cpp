#include "server/runtime/error_counters.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kinship::runtime::error_counters_test {
namespace {

class Troubles : public testing::Test {
 protected:
  std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
  Clock clock_{.now = [this] { return now_; }, .unix_ms = [] { return std::int64_t{17}; }};
  std::vector<std::string> lines_;
  ErrorCounters errors_{clock_, [this](std::string_view line) { lines_.emplace_back(line); }};
};

TEST_F(Troubles, AreCountedByKindWithTheLastOneInWords) {
  errors_.add(Trouble::FetchBusy, "too many");
  errors_.add(Trouble::ReportRefused, "bad", 3);
  errors_.add(Trouble::FetchBusy, "stopping");
  errors_.add(Trouble::AdminFailed, "nothing", 0);
  const std::vector<TroubleCount> counts = errors_.counts();
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].what, "report refused");
  EXPECT_EQ(counts[0].count, 3U);
  EXPECT_EQ(counts[1].count, 2U);
  EXPECT_EQ(counts[1].last, "stopping");
  EXPECT_EQ(counts[1].last_ms, 17);
}

TEST_F(Troubles, ABurstIsOneLine) {
  for (int i = 0; i < 1000; ++i) {
    errors_.add(Trouble::FetchBusy, "too many");
    now_ += std::chrono::milliseconds(100);
  }
  EXPECT_EQ(lines_, std::vector<std::string>{"fetch busy: too many"});
  now_ += ErrorCounters::kQuiet;
  errors_.add(Trouble::FetchBusy, "again");
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_EQ(lines_[1], "fetch busy: again (999 more since the last such line)");
}

}  // namespace
}  // namespace kinship::runtime::error_counters_test
