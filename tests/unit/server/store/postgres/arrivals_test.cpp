#include "server/store/postgres/rows/arrivals.hpp"

#include <algorithm>

#include "server/store/postgres/database/transaction.hpp"
#include "server/store/postgres/rows/export_rows.hpp"
#include "server/store/values/codes.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/store/postgres/empty_store.hpp"

/// Exports and feeds while several servers commit: ids and transactions become visible out of
/// order.
namespace kinship::store::postgres::arrivals_test {
namespace {

class Arrivals : public EmptyStore {
 protected:
  void SetUp() override {
    EmptyStore::SetUp();
    if (IsSkipped())
      return;
    connection_->query(
        "INSERT INTO robot (digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes,"
        " registered_ms, crc32c, urdf) "
        "VALUES (sha256('1'), 'panda', 7, 'base', 'tip', decode(repeat('00', 56), 'hex'), 0, 1,"
        " 0, '')");
    connection_->query("INSERT INTO task (name) VALUES ('shelf'), ('table')");
    connection_->query("INSERT INTO experience (task_id, robot_id) VALUES (1, 1), (2, 1)");
  }
  static void insert(Connection& connection, std::uint64_t number, std::int64_t task_id = 1) {
    connection.query(
        "INSERT INTO attempt (report_uuid, body_sha256, task_id, robot_id, status, machine,"
        " outcome, planner, planner_options, planning_time_s, collision_checks, projections,"
        " time_limit_s, sampling_mode, share, distribution_revision, received_ms) "
        "VALUES ($1, sha256(''), $2, 1, 3, 'cell', 2, 'rrt', '', 1, 1, 0, 1, 2, 0, 0, 1)",
        Bytes(test::id_from<Uuid>(number).bytes), task_id);
  }
  void insert(std::uint64_t number) { insert(*connection_, number); }

  Page<Attempt> export_after(const std::string& cursor, std::size_t limit,
                             const PairFilter& filter = {}) {
    const Transaction snapshot(*connection_, Transaction::Kind::Snapshot);
    DamagedRows noticed;
    return export_page(*connection_, filter, cursor, limit, 1'000'000, noticed);
  }
  /// The numbers of the attempts of an export from a cursor to its end.
  std::vector<std::uint64_t> rest(std::string cursor, std::size_t limit,
                                  const PairFilter& filter = {}) {
    std::vector<std::uint64_t> numbers;
    do {
      const Page<Attempt> page = export_after(cursor, limit, filter);
      for (const Attempt& attempt : page.rows)
        numbers.push_back(number_of(attempt.report_uuid));
      cursor = page.next_cursor;
    } while (!cursor.empty());
    return numbers;
  }
  static std::uint64_t number_of(const Uuid& uuid) {
    std::uint64_t number = 0;
    while (test::id_from<Uuid>(number) != uuid)
      ++number;
    return number;
  }
  using Numbers = std::vector<std::uint64_t>;
};

TEST_F(Arrivals, AnExportMissesNothingThatIsCommittedLate) {
  for (std::uint64_t number = 1; number <= 3; ++number)
    insert(number);
  const auto other = connect();
  Transaction late(*other, Transaction::Kind::Write);
  insert(*other, 10);
  for (std::uint64_t number = 4; number <= 6; ++number)
    insert(number);
  const Page<Attempt> first = export_after("", 2);
  ASSERT_EQ(first.rows.size(), 2U);
  const Page<Attempt> second = export_after(first.next_cursor, 2);
  ASSERT_EQ(second.rows.size(), 1U) << "what may still get something before it waits";
  EXPECT_EQ(number_of(second.rows[0].report_uuid), 3U);
  ASSERT_EQ(late.commit().certainty, Certainty::Committed);
  EXPECT_EQ(rest(second.next_cursor, 2), (Numbers{10, 4, 5, 6}));
  const PairFilter shelf{.robot = {}, .task = "shelf"};
  EXPECT_EQ(rest("", 2, shelf), (Numbers{1, 2, 3, 10, 4, 5, 6}));
}

TEST_F(Arrivals, AFeedEndsBeforeWhatIsStillOpenAndSkipsNothing) {
  const auto retire = [](Connection& connection, std::uint64_t number) {
    connection.query("INSERT INTO retired_report (report_uuid, retired_ms) VALUES ($1, 1)",
                     Bytes(test::id_from<Uuid>(number).bytes));
  };
  /// Behind a cursor, which is moved.
  const auto arrived = [this](std::string_view task, std::string& cursor) {
    Numbers numbers;
    const Feed<ArrivedReport> feed = feed_of_arrivals(*connection_, task, cursor, 100);
    for (const ArrivedReport& report : feed.rows)
      numbers.push_back(number_of(report.report_uuid));
    cursor = feed.cursor;
    return numbers;
  };
  const auto retired = [this](std::string& cursor) {
    Numbers numbers;
    const Feed<Uuid> feed = feed_of_retirements(*connection_, cursor, 100);
    for (const Uuid& report : feed.rows)
      numbers.push_back(number_of(report));
    cursor = feed.cursor;
    return numbers;
  };
  insert(1);
  retire(*connection_, 1);
  const auto other = connect();
  Transaction late(*other, Transaction::Kind::Write);
  insert(*other, 10);
  retire(*other, 10);
  insert(2);
  retire(*connection_, 2);
  std::string all, shelf, list;
  EXPECT_EQ(arrived("", all), (Numbers{1}));
  EXPECT_EQ(arrived("shelf", shelf), (Numbers{1}));
  EXPECT_EQ(retired(list), (Numbers{1}));
  ASSERT_EQ(late.commit().certainty, Certainty::Committed);
  EXPECT_EQ(arrived("", all), (Numbers{10, 2}));
  EXPECT_EQ(arrived("shelf", shelf), (Numbers{10, 2}));
  EXPECT_EQ(retired(list), (Numbers{10, 2}));
  EXPECT_EQ(arrived("", all), Numbers());
}

TEST_F(Arrivals, TheLastPageHasWhatIsCommittedByNow) {
  const auto other = connect();
  const Transaction open(*other, Transaction::Kind::Write);
  insert(*other, 10);
  for (std::uint64_t number = 1; number <= 3; ++number)
    insert(number);
  EXPECT_EQ(rest("", 3), (Numbers{1, 2, 3}));
}

TEST_F(Arrivals, AnExportEndsAlthoughATransactionStaysOpen) {
  insert(1);
  const auto other = connect();
  const Transaction open(*other, Transaction::Kind::Write);
  insert(*other, 10);
  for (std::uint64_t number = 2; number <= 6; ++number)
    insert(number);
  EXPECT_EQ(rest("", 2), (Numbers{1, 2, 3, 4, 5, 6}));
}

TEST_F(Arrivals, RobotsAndTasksAreMergedAsTheyArrived) {
  for (std::uint64_t number = 1; number <= 9; ++number)
    insert(*connection_, number, number % 3 == 0 ? 2 : 1);
  const PairFilter both{
      .robot = id_of<Digest>(connection_->query("SELECT digest FROM robot").front().column_blob(0)),
      .task = ""};
  EXPECT_EQ(rest("", 2, both), (Numbers{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(rest("", 2, {.robot = {}, .task = "table"}), (Numbers{3, 6, 9}));
  EXPECT_THROW(rest("5", 2), Failure);
  EXPECT_THROW(rest("5:-1", 2), Failure);
}

}  // namespace
}  // namespace kinship::store::postgres::arrivals_test
