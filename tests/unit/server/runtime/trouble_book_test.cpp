#include "server/runtime/trouble_book.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kinship::runtime::trouble_book_test {
namespace {

class Troubles : public testing::Test {
 protected:
  std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
  Clock clock_{.now = [this] { return now_; }, .unix_ms = [] { return std::int64_t{17}; }};
  std::vector<std::string> lines_;
  TroubleBook book_{clock_, [this](std::string_view line) { lines_.emplace_back(line); }};
};

TEST_F(Troubles, AreCountedByKindWithTheLastOneInWords) {
  book_.add(Trouble::FetchBusy, "too many");
  book_.add(Trouble::ReportRefused, "bad", 3);
  book_.add(Trouble::FetchBusy, "stopping");
  book_.add(Trouble::AdminFailed, "nothing", 0);
  const std::vector<TroubleCount> counts = book_.counts();
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].what, "report refused");
  EXPECT_EQ(counts[0].count, 3U);
  EXPECT_EQ(counts[1].count, 2U);
  EXPECT_EQ(counts[1].last, "stopping");
  EXPECT_EQ(counts[1].last_ms, 17);
}

TEST_F(Troubles, ABurstIsOneLine) {
  for (int i = 0; i < 1000; ++i) {
    book_.add(Trouble::FetchBusy, "too many");
    now_ += std::chrono::milliseconds(100);
  }
  EXPECT_EQ(lines_, std::vector<std::string>{"fetch busy: too many"});
  now_ += TroubleBook::kQuiet;
  book_.add(Trouble::FetchBusy, "again");
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_EQ(lines_[1], "fetch busy: again (999 more since the last such line)");
}

}  // namespace
}  // namespace kinship::runtime::trouble_book_test
