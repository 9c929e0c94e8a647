#include "server/sites/carry.hpp"

#include "proto/types/hex.hpp"
#include "proto/types/limits.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites {
namespace {

class Carry : public SiteAndMemory {
 protected:
  CarriedPage carry(const Piece& piece = {}) {
    const CarriedPage page =
        carry_page({.from = *site_, .to = *memory_}, "", cursor_, retired_, piece);
    cursor_ = page.cursor;
    return page;
  }

  std::string cursor_, retired_;
};

TEST_F(Carry, ReportsGoWithTheirRobotInTheOrderTheyCame) {
  test::report(*site_, {solved(3), test::make_unsolved(panda_.digest, "shelf", 1), solved(2)});
  const CarriedPage page = carry();
  EXPECT_EQ(page.looked_at, 3U);
  EXPECT_EQ(page.reports.new_there, 3U);
  EXPECT_FALSE(page.has_more);
  EXPECT_EQ(reports_of(*memory_), reports_of(*site_));
  EXPECT_EQ(memory_->find_robot(panda_.digest)->description.label, "panda");
  EXPECT_EQ(carry().looked_at, 0U);
}

TEST_F(Carry, WhatIsThereIsNotSentAgain) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  test::report(*site_, {solved(1), solved(2)});
  test::report(*memory_, {solved(1)});
  const CarriedPage page = carry();
  EXPECT_EQ(page.looked_at, 2U);
  EXPECT_EQ(page.reports.new_there, 1U);
}

TEST_F(Carry, APieceIsNoMoreThanItMayBe) {
  for (std::uint64_t number = 1; number <= 7; ++number)
    test::report(*site_, {solved(number)});
  const CarriedPage first = carry({.reports = 5, .commit = 2, .bytes = 1, .retirements = 1});
  EXPECT_EQ(first.looked_at, 5U);
  EXPECT_TRUE(first.has_more);
  EXPECT_EQ(reports_of(*memory_).size(), 5U);
  EXPECT_FALSE(carry({.reports = 5}).has_more);
  EXPECT_EQ(reports_of(*memory_), reports_of(*site_));
}

TEST_F(Carry, ALabelThatAnotherRobotHasIsKeptByThatOne) {
  store::RobotRecord other = test::make_robot("panda", 7);
  ASSERT_TRUE(memory_->register_robot(other));
  test::report(*site_, {solved(1)});
  EXPECT_EQ(carry().reports.new_there, 1U);
  EXPECT_EQ(memory_->find_robot(other.digest)->description.label, "panda");
  EXPECT_EQ(memory_->find_robot(panda_.digest)->description.label,
            "panda-" + panda_.digest.short_hex());
}

TEST_F(Carry, AlsoALongLabelLeavesRoomForTheDigest) {
  const std::string longest(kMaxLabelBytes, 'x');
  store::RobotRecord here = test::make_robot(longest, 8), there = test::make_robot(longest, 9);
  ASSERT_TRUE(site_->register_robot(here));
  ASSERT_TRUE(memory_->register_robot(there));
  test::report(*site_, {test::make_attempt(here.digest, "shelf", 1)});
  EXPECT_EQ(carry().reports.new_there, 1U);
  EXPECT_TRUE(
      memory_->find_robot(here.digest)->description.label.ends_with(here.digest.short_hex()));
}

TEST_F(Carry, WhatIsRefusedIsNamedAndHoldsNothingUp) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  Attempt other = solved(9);
  other.report_uuid = solved(1).report_uuid;
  test::report(*memory_, {other});
  test::report(*site_, {solved(1), solved(2)});
  const CarriedReports carried = carry().reports;
  ASSERT_EQ(carried.refused.size(), 1U);
  EXPECT_EQ(carried.refused[0].report_uuid, solved(1).report_uuid);
  EXPECT_NE(carried.refused[0].why.find("another report"), std::string::npos);
  EXPECT_EQ(carried.new_there, 1U);
}

TEST_F(Carry, WhatTheOtherStorePutsOffAloneHoldsNothingUp) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  store::Database(directory_ / "memory.db", store::Access::ReadWrite)
      .execute("CREATE TRIGGER object BEFORE INSERT ON attempt WHEN NEW.report_uuid = x'" +
               to_hex(solved(1).report_uuid.bytes) +
               "' BEGIN SELECT RAISE(ABORT, 'the administrator objects'); END");
  for (const std::uint64_t number : {1U, 2U, 3U})
    test::report(*site_, {solved(number)});
  const CarriedReports carried = carry({.commit = 1}).reports;
  ASSERT_EQ(carried.refused.size(), 1U);
  EXPECT_EQ(carried.refused[0].report_uuid, solved(1).report_uuid);
  EXPECT_NE(carried.refused[0].why.find("the administrator objects"), std::string::npos);
  EXPECT_EQ(carried.new_there, 2U);
}

TEST_F(Carry, WhatIsFoundWrongOnTheWayIsNotCommitted) {
  test::report(*site_, {solved(1), solved(2)});
  const auto check = [this](const Attempt& attempt) -> std::optional<Error> {
    if (attempt.report_uuid == solved(1).report_uuid)
      return Error{ErrorCode::InvalidInput, "joint 2 beyond its limit"};
    return std::nullopt;
  };
  const CarriedPage page =
      carry_page({.from = *site_, .to = *memory_, .check = check}, "", cursor_, retired_, {});
  ASSERT_EQ(page.reports.refused.size(), 1U);
  EXPECT_EQ(page.reports.refused[0].why, "joint 2 beyond its limit");
  EXPECT_EQ(reports_of(*memory_), std::vector<Uuid>{solved(2).report_uuid});
}

TEST_F(Carry, AStoreThatWantsItAgainIsAskedAgain) {
  test::report(*site_, {solved(1)});
  store::TroubledStore busy(*memory_);
  busy.on_commit = [](const std::vector<store::ReplicatedReport>& reports,
                      const store::Store::ReportsDone& done) {
    std::vector<Receipt> receipts;
    for (const store::ReplicatedReport& report : reports)
      receipts.push_back(
          {report.attempt.report_uuid, ReceiptStatus::TryAgain, "the queue is full"});
    done(receipts);
  };
  try {
    carry_page({.from = *site_, .to = busy}, "", cursor_, retired_, {});
    FAIL() << "carried";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("the queue is full"), std::string::npos);
  }
  EXPECT_EQ(carry().reports.new_there, 1U);
}

TEST_F(Carry, ARobotThatIsRemovedOnTheWayIsNotTheEndOfItsReports) {
  test::report(*site_, {solved(1)});
  store::TroubledStore memory(*memory_);
  memory.on_commit = [&](std::vector<store::ReplicatedReport> reports,
                         store::Store::ReportsDone done) {
    EXPECT_TRUE(memory_->remove_robot(panda_.digest));
    memory_->commit_replicated(std::move(reports), std::move(done));
  };
  EXPECT_THROW(carry_page({.from = *site_, .to = memory}, "", cursor_, retired_, {}), Failure);
  EXPECT_TRUE(reports_of(*memory_).empty());
  EXPECT_EQ(carry().reports.new_there, 1U);
}

TEST_F(Carry, WhatCannotBeLookedAtNowIsNotRefused) {
  test::report(*site_, {solved(1)});
  const auto check = [](const Attempt&) {
    return std::optional(Error{ErrorCode::Storage, "the robot cannot be read"});
  };
  EXPECT_THROW(
      carry_page({.from = *site_, .to = *memory_, .check = check}, "", cursor_, retired_, {}),
      Failure);
  EXPECT_EQ(carry().reports.new_there, 1U);
}

TEST_F(Carry, ADroppedPathIsCounted) {
  site_.reset();
  site_ = store::open_sqlite_store(directory_ / "site.db", {.max_paths_per_pair = 1});
  test::report(*site_, {solved(1), solved(2)});
  const CarriedPage page = carry();
  EXPECT_EQ(page.reports.new_there, 1U);
  EXPECT_EQ(page.reports.left_out, 1U);
}

TEST_F(Carry, ARetirementIsCarriedAlsoForReportsOfBeforeTheList) {
  test::report(*site_, {solved(1), solved(2)});
  carry();
  ASSERT_TRUE(site_->retire_path(solved(1).report_uuid));
  std::uint64_t paths = 0;
  carry_page({.from = *site_,
              .to = *memory_,
              .on_retired = [&](const Retirement& retirement) { paths += retirement.paths; }},
             "", cursor_, retired_, {});
  EXPECT_EQ(paths, 1U);
  EXPECT_EQ(paths_of(*memory_), 1U);
  EXPECT_EQ(carry_retirements({.from = *site_, .to = *memory_}, retired_, {}), 0U);
  // As of a store whose list began after the retirement.
  std::string from_now = site_->list_retirements("", 10).cursor;
  const auto other = store::open_sqlite_store(directory_ / "other.db");
  ASSERT_TRUE(other->register_robot(panda_));
  test::report(*other, {solved(1)});
  carry_page({.from = *site_, .to = *other}, "", "", from_now, {});
  EXPECT_EQ(paths_of(*other), 1U) << "of report 2 alone";
}

TEST_F(Carry, ContentThatWasReportedAnewAfterARetirementStays) {
  test::report(*site_, {solved(1)});
  carry();
  Attempt anew = solved(1);
  anew.report_uuid = test::id_from<Uuid>(50);
  // Each of the two happens before or after any call of a page that carries a third report.
  for (int retired_at = 1; retired_at <= 7; ++retired_at)
    for (int reported_at = retired_at; reported_at <= 7; ++reported_at) {
      const std::string name = std::to_string(retired_at) + "_" + std::to_string(reported_at);
      const auto here = store::open_sqlite_store(directory_.path() / ("here_" + name));
      const auto there = store::open_sqlite_store(directory_.path() / ("there_" + name));
      for (store::Store* const store : {here.get(), there.get()}) {
        ASSERT_TRUE(store->register_robot(panda_));
        test::report(*store, {solved(1)});
      }
      test::report(*here, {solved(2)});
      store::TroubledStore from(*here);
      int calls = 0;
      from.on_exchange = [&] {
        ++calls;
        if (calls == retired_at) {
          ASSERT_TRUE(here->retire_path(solved(1).report_uuid));
        }
        if (calls == reported_at)
          test::report(*here, {anew});
      };
      std::string cursor, retired;
      for (int page = 0; page < 3; ++page)
        cursor = carry_page({.from = from, .to = *there}, "", cursor, retired, {}).cursor;
      ASSERT_GE(calls, 7);
      const auto paths = there->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 9});
      ASSERT_EQ(paths.size(), 2U) << name;
      EXPECT_EQ(paths[0].report_uuid, solved(2).report_uuid);
      EXPECT_EQ(paths[1].report_uuid, anew.report_uuid);
    }
}

TEST_F(Carry, ARetirementThatCouldNotBeToldIsToldAgain) {
  test::report(*site_, {solved(1), solved(2)});
  carry();
  ASSERT_TRUE(site_->reset_task("shelf"));
  store::TroubledStore cut(*memory_);
  cut.on_exchange = [] { throw Failure(ErrorCode::Unavailable, "the line was cut"); };
  EXPECT_THROW(carry_retirements({.from = *site_, .to = cut}, retired_, {}), Failure);
  EXPECT_EQ(paths_of(*memory_), 2U);
  EXPECT_EQ(carry_retirements({.from = *site_, .to = *memory_}, retired_, {}), 2U);
  EXPECT_EQ(paths_of(*memory_), 0U);
}

TEST_F(Carry, ALongListOfRetirementsIsToldPieceByPiece) {
  constexpr std::uint64_t kPaths = 50;
  for (std::uint64_t number = 1; number <= kPaths; ++number)
    test::report(*site_, {solved(number)});
  carry();
  ASSERT_TRUE(site_->reset_task("shelf"));
  std::vector<std::size_t> told;
  int rests = 0;
  const Way way{.from = *site_,
                .to = *memory_,
                .retire =
                    [&](std::span<const Uuid> reports) {
                      told.push_back(reports.size());
                      EXPECT_EQ(static_cast<std::size_t>(rests), told.size());
                      return memory_->retire_reports(reports);
                    },
                .before_write = [&] { ++rests; }};
  EXPECT_EQ(carry_retirements(way, retired_, {.retirements = 20}), kPaths);
  EXPECT_EQ(told, (std::vector<std::size_t>{20, 20, 10}));
  EXPECT_EQ(rests, 3);
  // The same where the list does not say so: as of one that lost entries in a repair.
  const auto other = store::open_sqlite_store(directory_ / "other.db");
  ASSERT_TRUE(other->register_robot(panda_));
  for (std::uint64_t number = 1; number <= kPaths; ++number)
    test::report(*other, {solved(number)});
  told.clear();
  rests = 0;
  std::string from_now = retired_;
  Way to_other{.from = *site_,
               .to = *other,
               .retire =
                   [&](std::span<const Uuid> reports) {
                     told.push_back(reports.size());
                     return other->retire_reports(reports);
                   },
               .before_write = [&] { ++rests; }};
  carry_page(to_other, "", "", from_now, {.retirements = 20});
  EXPECT_EQ(told, (std::vector<std::size_t>{20, 20, 10}));
  EXPECT_EQ(rests, 3);
  EXPECT_EQ(paths_of(*other), 0U);
}

TEST_F(Carry, WhoStopsDoesNotWaitForAStoreThatNeverAnswers) {
  test::report(*site_, {solved(1)});
  store::TroubledStore silent(*memory_);
  std::stop_source stop;
  silent.on_commit = [&](const std::vector<store::ReplicatedReport>&,
                         const store::Store::ReportsDone&) { stop.request_stop(); };
  EXPECT_THROW(carry_page({.from = *site_, .to = silent, .stop = stop.get_token()}, "", cursor_,
                          retired_, {}),
               Failure);
}

}  // namespace
}  // namespace kinship::sites
