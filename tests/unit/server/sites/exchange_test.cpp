#include "server/sites/exchange.hpp"

#include <fstream>
#include <thread>

#include "tests/support/server_process.hpp"
#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites {
namespace {

class ExchangeTest : public SiteAndMemory {
 protected:
  ExchangeTest() {
    options_.look_every = std::chrono::milliseconds(0);
    options_.log = [this](std::string_view line) { lines_.emplace_back(line); };
    hooks_.tasks_in_use = [this] { return in_use_; };
    EXPECT_TRUE(memory_->register_robot(panda_));
  }

  void connect() {
    exchange_.reset();
    positions_.emplace(*site_);
    exchange_.emplace(*site_, *memory_, *positions_, counts_, hooks_, options_);
  }
  /// Until a round of all streams finds nothing.
  void exchange() {
    if (!exchange_)
      connect();
    constexpr int kIdle = 8;
    for (int idle = 0; idle < kIdle;) {
      const Exchange::Step step = exchange_->step();
      load_ += step.load;
      idle = step.has_worked ? 0 : idle + 1;
    }
  }
  Attempt other_task(std::uint64_t number) const {
    return test::make_attempt(panda_.digest, "table", number);
  }

  std::set<std::string> in_use_;
  SiteHooks hooks_;
  ExchangeOptions options_;
  ExchangeCounts counts_;
  std::vector<std::string> lines_;
  std::chrono::nanoseconds load_{0};
  std::optional<Positions> positions_;
  std::optional<Exchange> exchange_;
};

TEST_F(ExchangeTest, UpGoesAllDownComesWhatIsUsedHere) {
  test::report(*site_, {solved(1), other_task(2)});
  test::report(*memory_, {solved(11), other_task(12)});
  in_use_ = {"shelf"};
  exchange();
  EXPECT_EQ(memory_->status().attempts, 4U);
  EXPECT_EQ(site_->status().attempts, 3U);
  EXPECT_TRUE(site_->find_attempt(solved(11).report_uuid));
  EXPECT_EQ(counts_.sent, 2U);
  EXPECT_EQ(counts_.received, 1U);
  in_use_ = {"table"};
  exchange();
  EXPECT_EQ(site_->status().attempts, 4U);
  EXPECT_EQ(counts_.sent, 2U) << "what came down does not go up again";
  EXPECT_EQ(positions_->passed, 4U) << "and does not wait to be sent";
}

TEST_F(ExchangeTest, TasksOfAPatternAlwaysComeDown) {
  options_.task_patterns = {"ta*"};
  test::report(*memory_, {solved(11), other_task(12)});
  exchange();
  EXPECT_EQ(reports_of(*site_), std::vector<Uuid>{other_task(12).report_uuid});
}

TEST_F(ExchangeTest, ATaskThatNobodyUsesForLongDoesNotComeDownAnyMore) {
  std::int64_t now_ms = 1'700'000'000'000;
  options_.clock.unix_ms = [&] { return now_ms; };
  in_use_ = {"shelf"};
  exchange();
  in_use_.clear();
  now_ms += std::chrono::milliseconds(options_.task_use).count() - 1;
  test::report(*memory_, {solved(11)});
  connect();
  exchange();
  EXPECT_EQ(site_->status().attempts, 1U) << "also after a restart";
  now_ms += 2;
  test::report(*memory_, {solved(12)});
  exchange();
  EXPECT_EQ(site_->status().attempts, 1U);
  in_use_ = {"shelf"};
  exchange();
  EXPECT_EQ(site_->status().attempts, 2U);
}

TEST_F(ExchangeTest, RetirementsGoBothWaysAlsoWhereNoTaskIsUsed) {
  test::report(*site_, {solved(1), solved(2)});
  std::vector<Retirement> told;
  hooks_.on_retired = [&](const Retirement& retirement) { told.push_back(retirement); };
  exchange();
  ASSERT_TRUE(memory_->retire_path(solved(1).report_uuid));
  ASSERT_TRUE(site_->retire_path(solved(2).report_uuid));
  exchange();
  EXPECT_EQ(paths_of(*site_), 0U);
  EXPECT_EQ(paths_of(*memory_), 0U);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].task, "shelf");
  EXPECT_EQ(counts_.retired_here, 1U);
  EXPECT_EQ(counts_.retired_above, 1U);
}

TEST_F(ExchangeTest, AMemoryThatLostWhatItAcknowledgedGetsItAgain) {
  test::report(*site_, {solved(1)});
  exchange();
  // Its machine goes back in time: the same file with its high-water mark, so that it cannot tell
  // itself.
  const std::vector<std::filesystem::path> files = {directory_ / "memory.db",
                                                    directory_ / "memory.db.high-water-mark"};
  exchange_.reset();
  memory_.reset();
  std::vector<std::string> before;
  for (const std::filesystem::path& file : files)
    before.push_back(test::read_text(file));
  memory_ = store::open_sqlite_store(files[0]);
  const Uuid epoch = memory_->epoch();
  connect();
  test::report(*site_, {solved(2)});
  exchange();
  EXPECT_EQ(memory_->status().attempts, 2U);
  exchange_.reset();
  memory_.reset();
  for (std::size_t i = 0; i < files.size(); ++i)
    std::ofstream(files[i], std::ios::binary | std::ios::trunc) << before[i];
  memory_ = store::open_sqlite_store(files[0]);
  ASSERT_EQ(memory_->epoch(), epoch);
  EXPECT_EQ(memory_->status().attempts, 1U);
  lines_.clear();
  connect();
  exchange();
  EXPECT_EQ(memory_->status().attempts, 2U);
  EXPECT_NE(memory_->epoch(), epoch) << "its other sites begin again, too";
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_NE(lines_[0].find("rolled back"), std::string::npos);
}

TEST_F(ExchangeTest, AnEpochThatChangesWhileConnectedBeginsAgain) {
  test::report(*site_, {solved(1)});
  exchange();
  ASSERT_EQ(lines_.size(), 1U) << "the first time is a beginning, too";
  const auto other = store::open_sqlite_store(directory_ / "other.db");
  ASSERT_TRUE(other->register_robot(panda_));
  exchange_.emplace(*site_, *other, *positions_, counts_, hooks_, options_);
  exchange();
  EXPECT_EQ(lines_.size(), 2U);
  EXPECT_EQ(reports_of(*other), reports_of(*site_));
}

TEST_F(ExchangeTest, WhatIsRefusedIsSetAsideAndTriedWithTheNextConnection) {
  bool is_refusing = true;
  hooks_.check = [&](const Attempt& attempt) -> std::optional<Error> {
    if (is_refusing && attempt.report_uuid == solved(11).report_uuid)
      return Error{ErrorCode::InvalidInput, "no path of this robot"};
    return std::nullopt;
  };
  in_use_ = {"shelf"};
  test::report(*memory_, {solved(11), solved(12)});
  exchange();
  EXPECT_EQ(reports_of(*site_), std::vector<Uuid>{solved(12).report_uuid});
  ASSERT_EQ(positions_->refused_count(), 1U);
  EXPECT_EQ(positions_->refused(false).begin()->second.why, "no path of this robot");
  EXPECT_NE(lines_.back().find(solved(11).report_uuid.text()), std::string::npos);
  connect();
  exchange();
  EXPECT_EQ(positions_->refused_count(), 1U) << "refused again";
  is_refusing = false;
  connect();
  exchange();
  EXPECT_EQ(positions_->refused_count(), 0U);
  EXPECT_EQ(site_->status().attempts, 2U);
}

TEST_F(ExchangeTest, WhatIsRefusedIsTriedAgainLessAndLessOftenWhileTheLineHolds) {
  auto now = std::chrono::steady_clock::now();
  options_.clock.now = [&] { return now; };
  int tries = 0;
  bool is_refusing = true;
  store::TroubledStore memory(*memory_);
  memory.on_commit = [&](std::vector<store::ReplicatedReport> reports,
                         const store::Store::ReportsDone& done) {
    ++tries;
    if (!is_refusing)
      return memory_->commit_replicated(std::move(reports), done);
    std::vector<Receipt> receipts;
    for (const store::ReplicatedReport& report : reports)
      receipts.push_back({report.attempt.report_uuid, ReceiptStatus::Refused, "not here"});
    done(receipts);
  };
  test::report(*site_, {solved(1)});
  positions_.emplace(*site_);
  exchange_.emplace(*site_, memory, *positions_, counts_, hooks_, options_);
  const auto step_for = [&](std::chrono::seconds time) {
    for (const auto end = now + time; now < end; now += std::chrono::seconds(5))
      for (int stream = 0; stream < 4; ++stream)
        exchange_->step();
  };
  step_for(std::chrono::hours(2));
  EXPECT_GT(tries, 10) << "every ten minutes in the end";
  EXPECT_LT(tries, 40);
  EXPECT_EQ(std::ranges::count_if(
                lines_,
                [](const std::string& line) { return line.find("not here") != std::string::npos; }),
            1)
      << "told once";
  ASSERT_EQ(positions_->refused_count(), 1U);
  is_refusing = false;
  step_for(options_.longest_refused_retry / std::chrono::seconds(1) * std::chrono::seconds(1));
  EXPECT_EQ(positions_->refused_count(), 0U);
  EXPECT_EQ(reports_of(*memory_), reports_of(*site_));
  exchange_.reset();
}

TEST_F(ExchangeTest, NothingWaitsBehindMoreRefusalsThanAreKept) {
  hooks_.check = [&](const Attempt& attempt) -> std::optional<Error> {
    if (attempt.report_uuid == solved(11).report_uuid)
      return Error{ErrorCode::InvalidInput, "no path of this robot"};
    return std::nullopt;
  };
  in_use_ = {"shelf"};
  exchange();  // connected: refused reports are due again in some seconds
  for (std::uint64_t number = 0; number < Positions::kMaxRefused; ++number)
    positions_->refuse({test::id_from<Uuid>(1'000'000 + number), "refused before"}, false);
  test::report(*memory_, {solved(11), solved(12)});
  exchange();
  EXPECT_EQ(reports_of(*site_), std::vector<Uuid>{solved(12).report_uuid});
  EXPECT_EQ(counts_.passed_by, 1U);
  EXPECT_NE(lines_.back().find("it is not tried again"), std::string::npos) << lines_.back();
}

TEST_F(ExchangeTest, OneUuidWithTwoContentsIsNamedWhereItMeetsTheOther) {
  Attempt other = solved(9);
  other.report_uuid = solved(1).report_uuid;
  test::report(*memory_, {other});
  test::report(*site_, {solved(1), solved(2)});
  in_use_ = {"shelf"};
  exchange();
  ASSERT_EQ(positions_->refused_count(), 2U) << "by each";
  for (const bool is_up : {false, true})
    EXPECT_NE(
        positions_->refused(is_up).at(other.report_uuid).why.find("was used for another report"),
        std::string::npos);
  EXPECT_EQ(site_->find_attempt(other.report_uuid)->path->waypoints(), solved(1).path->waypoints())
      << "each keeps its own";
  EXPECT_EQ(memory_->find_attempt(other.report_uuid)->path->waypoints(), other.path->waypoints());
}

TEST_F(ExchangeTest, WhatCameDownIsHandedToTheServerOfTheSite) {
  std::size_t most = 0, all = 0;
  hooks_.commit = [&](std::vector<store::ReplicatedReport> reports,
                      store::Store::ReportsDone done) {
    most = std::max(most, reports.size());
    all += reports.size();
    site_->commit_replicated(std::move(reports), std::move(done));
  };
  options_.down = {.reports = 8, .commit = 3};
  in_use_ = {"shelf"};
  for (std::uint64_t number = 1; number <= 20; ++number)
    test::report(*memory_, {solved(number)});
  exchange();
  EXPECT_EQ(all, 20U);
  EXPECT_EQ(most, 3U);
}

TEST_F(ExchangeTest, ARemovalOfARobotRetiresItsPathsAbove) {
  test::report(*site_, {solved(1), other_task(2)});
  exchange();
  ASSERT_EQ(paths_of(*memory_), 2U);
  ASSERT_TRUE(site_->remove_robot(panda_.digest));
  in_use_ = {"shelf"};
  exchange();
  EXPECT_EQ(paths_of(*memory_), 0U);
  EXPECT_TRUE(memory_->find_robot(panda_.digest)) << "other sites may have it";
  EXPECT_FALSE(site_->find_robot(panda_.digest)) << "what it did does not bring it back";
  EXPECT_EQ(reports_of(*memory_).size(), 2U);
  test::report(*memory_, {solved(3)});
  exchange();
  EXPECT_TRUE(site_->find_robot(panda_.digest)) << "what it did since at another site does";
  EXPECT_EQ(paths_of(*site_), 1U);
}

TEST_F(ExchangeTest, RestsBetweenTwoTransactionsAtTheSite) {
  constexpr std::uint64_t kPaths = 40;
  for (std::uint64_t number = 1; number <= kPaths; ++number)
    test::report(*memory_, {solved(number)});
  options_.down = {.reports = 20, .commit = 10, .retirements = 8};
  in_use_ = {"shelf"};
  std::size_t written = 0, rested = 0;
  options_.rest = [&](std::chrono::nanoseconds load, const std::stop_token&) {
    ++rested;
    load_ += load;
  };
  constexpr std::chrono::milliseconds kSlow{1};  // of the site's disk
  hooks_.commit = [&](std::vector<store::ReplicatedReport> reports,
                      store::Store::ReportsDone done) {
    ++written;
    std::this_thread::sleep_for(kSlow);
    site_->commit_replicated(std::move(reports), std::move(done));
  };
  exchange();
  EXPECT_EQ(written, 4U);
  EXPECT_EQ(rested, 2U) << "and after each page whoever takes the steps";
  EXPECT_GE(load_, 4 * kSlow) << "for the time that robots here waited, too";
  rested = 0;
  load_ = {};
  ASSERT_TRUE(memory_->reset_task("shelf"));
  store::TroubledStore slow(*site_);
  slow.on_exchange = [&] { std::this_thread::sleep_for(kSlow); };
  exchange_.emplace(slow, *memory_, *positions_, counts_, hooks_, options_);
  exchange();
  EXPECT_EQ(paths_of(*site_), 0U);
  EXPECT_EQ(rested, 5U) << "between five pieces, and before the memory hears what it knows";
  EXPECT_GE(load_, 2 * 5 * kSlow);
  exchange_.reset();
}

TEST_F(ExchangeTest, HowFarItCameIsWrittenOnceASecond) {
  auto now = std::chrono::steady_clock::now();
  options_.clock.now = [&] { return now; };
  options_.look_every = std::chrono::hours(1);
  std::size_t written = 0;
  store::TroubledStore site(*site_);
  site.on_notes = [&] { ++written; };
  const auto cursor = [this] { return Positions(*site_).up; };
  positions_.emplace(site);
  exchange_.emplace(site, *memory_, *positions_, counts_, hooks_, options_);
  exchange_->step();
  written = 0;
  const std::string before = cursor();
  for (std::uint64_t number = 1; number <= 3; ++number) {
    test::report(*site_, {solved(number)});
    exchange_->look_up_now();
    EXPECT_TRUE(exchange_->step().has_worked);
  }
  EXPECT_EQ(reports_of(*memory_).size(), 3U);
  EXPECT_EQ(written, 0U) << "robots wait for each time";
  EXPECT_EQ(cursor(), before);
  const Exchange::Step idle = exchange_->step();
  EXPECT_LE(idle.next, now + options_.save_every) << "also if nothing more comes";
  now += options_.save_every;
  exchange_->step();
  EXPECT_EQ(written, 1U);
  EXPECT_EQ(cursor(), positions_->up);
  EXPECT_NE(cursor(), before);
  test::report(*site_, {solved(4)});
  exchange_->look_up_now();
  exchange_->step();
  exchange_->save_positions();
  EXPECT_EQ(cursor(), positions_->up) << "and when the line is lost";
  exchange_.reset();
}

TEST_F(ExchangeTest, SendingTakesTurnsWithWhatComesDown) {
  options_.up = {.reports = 1};
  options_.down = {.reports = 1};
  in_use_ = {"shelf"};
  for (std::uint64_t number = 1; number <= 6; ++number) {
    test::report(*site_, {other_task(number)});
    test::report(*memory_, {solved(10 + number)});
  }
  connect();
  for (int i = 0; i < 6; ++i)
    exchange_->step();
  EXPECT_EQ(counts_.sent, 3U);
  EXPECT_EQ(counts_.received, 3U);
}

}  // namespace
}  // namespace kinship::sites
