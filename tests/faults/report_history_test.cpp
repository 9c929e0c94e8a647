#include "tests/faults/report_history.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// The comparison that the fault tests rest on finds each fault that is put before it.
namespace kinship::test::report_history_test {
namespace {

using Kind = HistoryEntry::Kind;

class ReportHistory : public testing::Test {
 protected:
  ReportHistory() {
    for (const store::RobotRecord& robot : history_robots())
      EXPECT_TRUE(store_->register_robot(robot));
    for (const std::uint64_t number : {0U, 1U, 2U, 16U, 40U})
      send(number);
  }
  void note(HistoryEntry entry) {
    entry.ended_ns = entry.began_ns + 1;
    history_.push_back(entry);
  }
  void begin(std::uint64_t number) {
    note({.kind = Kind::Begun, .number = number, .began_ns = ++clock_ns_});
  }
  void answer(std::uint64_t number, ReceiptStatus status) {
    note({.kind = Kind::Answered,
          .number = number,
          .status = static_cast<std::uint32_t>(status),
          .began_ns = clock_ns_ += 10});
  }
  void send(std::uint64_t number) {
    begin(number);
    answer(number, report(*store_, {numbered_report(number)}).at(0).status);
  }
  void read(std::uint32_t client, std::uint64_t generation) {
    note({.kind = Kind::Read, .client = client, .number = generation, .began_ns = clock_ns_ += 10});
  }
  HistoryFaults faults() const { return find_faults(*store_, history_); }

  TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "s.db");
  std::vector<HistoryEntry> history_;
  std::int64_t clock_ns_ = 0;
};

TEST_F(ReportHistory, FindsNothingWhereNothingIsWrong) {
  read(1, 3);
  EXPECT_EQ(store_->generation(history_robots()[0].digest, history_task(0)), 3U);
  EXPECT_EQ(faults(), HistoryFaults{});
}

TEST_F(ReportHistory, FindsAReceiptWithoutAnAttempt) {
  begin(24);
  answer(24, ReceiptStatus::Stored);
  EXPECT_EQ(faults(), (HistoryFaults{.lost = 1, .pathless = 1}));
}

TEST_F(ReportHistory, FindsAnAttemptThatNobodyReported) {
  Attempt another = numbered_report(24);
  report(*store_, {another});
  EXPECT_EQ(faults(), (HistoryFaults{.unknown = 1}));
  another = numbered_report(32);
  another.record.collision_checks = 1;
  report(*store_, {another});
  begin(32);
  EXPECT_EQ(faults(), (HistoryFaults{.wrong = 1, .unknown = 1}));
}

TEST_F(ReportHistory, FindsARefusal) {
  begin(24);
  answer(24, ReceiptStatus::Refused);
  EXPECT_EQ(faults(), (HistoryFaults{.refused = 1}));
}

TEST_F(ReportHistory, FindsAGenerationThatGoesBack) {
  read(1, 3);
  read(2, 2);  // stale for a client that has seen nothing itself
  EXPECT_EQ(faults(), (HistoryFaults{.behind = 1}));
  read(1, 1);
  EXPECT_EQ(faults(), (HistoryFaults{.backwards = 1, .behind = 2}));
}

TEST_F(ReportHistory, FindsAReadingThatLacksWhatWasStoredBeforeIt) {
  read(1, 3);
  send(24);
  read(1, 3);
  EXPECT_EQ(faults(), (HistoryFaults{.behind = 1}));
}

}  // namespace
}  // namespace kinship::test::report_history_test
