#include "server/sites/forwarder.hpp"

#include <atomic>
#include <future>
#include <thread>

#include "server/sites/backoff.hpp"
#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites {
namespace {

using namespace std::chrono_literals;

class ForwarderTest : public SiteAndMemory {
 protected:
  ForwarderTest() {
    options_.name = "the memory";
    options_.first_retry = 1ms;
    options_.longest_retry = 4ms;
    options_.seed = 7;
    options_.exchange.look_every = 10ms;
    options_.on_line = [this](std::string_view line) {
      const std::lock_guard lock(mutex_);
      lines_.emplace_back(line);
    };
    options_.open = [this]() -> std::unique_ptr<store::Store> {
      if (is_cut_)
        throw Failure(ErrorCode::Unavailable, "no route to host");
      auto connection = std::make_unique<store::TroubledStore>(*memory_);
      connection->on_exchange = [this] {
        if (is_cut_)
          throw Failure(ErrorCode::Unavailable, "the line was cut");
      };
      return connection;
    };
  }
  /// What is to become true while others work; false after a long time.
  template <typename Condition>
  static bool comes_true(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (!condition() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(1ms);
    return condition();
  }
  UpstreamStatus status(const Forwarder& forwarder) const {
    return forwarder.status(site_->status().attempts);
  }
  std::vector<std::string> lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

  std::atomic<bool> is_cut_ = false;
  ForwarderOptions options_;
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

TEST_F(ForwarderTest, SendsWhatComesAndSaysHowItStands) {
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return status(forwarder).connected; }));
  test::report(*site_, {solved(1), solved(2)});
  forwarder.wake();
  ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 2; }));
  EXPECT_EQ(reports_of(*memory_), reports_of(*site_));
  const UpstreamStatus now = status(forwarder);
  EXPECT_EQ(now.name, "the memory");
  EXPECT_TRUE(now.message.empty());
  EXPECT_EQ(now.waiting, 0U);
  EXPECT_EQ(now.oldest_waiting_ms, 0);
  EXPECT_EQ(now.refused, 0U);
}

TEST_F(ForwarderTest, ALineThatIsCutComesBackAndEverybodyHears) {
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return status(forwarder).connected; }));
  is_cut_ = true;
  ASSERT_TRUE(comes_true([&] { return !status(forwarder).connected; }));
  test::report(*site_, {solved(1), solved(2), solved(3)});
  ASSERT_TRUE(comes_true([&] { return status(forwarder).oldest_waiting_ms > 0; }));
  EXPECT_EQ(status(forwarder).waiting, 3U);
  ASSERT_TRUE(comes_true([&] { return status(forwarder).tries > 2; }));
  EXPECT_EQ(status(forwarder).message, "no route to host");
  EXPECT_TRUE(reports_of(*memory_).empty());
  is_cut_ = false;
  ASSERT_TRUE(comes_true([&] { return status(forwarder).waiting == 0; }));
  EXPECT_EQ(reports_of(*memory_), reports_of(*site_));
  ASSERT_EQ(lines().size(), 3U) << "once each, however often it is tried";
  EXPECT_EQ(lines()[0], "connected with the memory");
  EXPECT_TRUE(lines()[1].starts_with("no connection with the memory: the line was cut"));
  EXPECT_EQ(lines()[2], lines()[0]);
}

TEST_F(ForwarderTest, ALineThatHeldIsTriedAgainSoon) {
  constexpr int kFailures = 8;  // after them it waits for 128 ms at least
  options_.longest_retry = 1h;
  std::atomic<int> opened = 0;
  std::atomic<std::chrono::steady_clock::duration> cut_at{}, shortest{1h};
  options_.open = [&]() -> std::unique_ptr<store::Store> {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    if (++opened <= kFailures)
      throw Failure(ErrorCode::Unavailable, "no route to host");
    if (opened > kFailures + 1)
      shortest = std::min(shortest.load(), now - cut_at.load());
    auto connection = std::make_unique<store::TroubledStore>(*memory_);
    connection->on_exchange = [&, calls = 0]() mutable {
      if (++calls < 100)
        return;
      cut_at = std::chrono::steady_clock::now().time_since_epoch();
      throw Failure(ErrorCode::Unavailable, "the line was cut");
    };
    return connection;
  };
  const Forwarder forwarder(*site_, options_);
  // Once at least nothing else keeps this machine that long.
  ASSERT_TRUE(comes_true([&] { return shortest.load() < 100ms; }));
}

TEST_F(ForwarderTest, ALineThatIsDownFromTheStartIsTold) {
  is_cut_ = true;
  const Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return status(forwarder).tries > 1; }));
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_EQ(lines()[0], "no connection with the memory: no route to host");
}

TEST_F(ForwarderTest, GoesOnWhereItWasAfterARestart) {
  test::report(*site_, {solved(1)});
  {
    Forwarder forwarder(*site_, options_);
    ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 1; }));
    test::report(*site_, {solved(2)});
    forwarder.wake();
    ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 2; }));
  }
  EXPECT_EQ(Positions(*site_).passed, 2U) << "written as it stops, though it is not time yet";
  test::report(*site_, {solved(3)});
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return reports_of(*memory_).size() == 3; }));
  ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 1; })) << "the first is not sent";
}

TEST_F(ForwarderTest, ReportsOfRobotsComeFirst) {
  std::atomic<int> asked = 0;
  options_.queued_reports = [&] { return ++asked < 4 ? std::size_t{1} : std::size_t{0}; };
  options_.exchange.up = {.reports = 1};
  test::report(*site_, {solved(1), solved(2)});
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 2; }));
  EXPECT_GE(asked, 4);
}

TEST_F(ForwarderTest, RobotsOfTheSiteWaitForOnePieceOfALongResetAtMost) {
  constexpr std::uint64_t kPaths = 30;
  for (std::uint64_t number = 1; number <= kPaths; ++number)
    test::report(*site_, {solved(number)});
  store::TroubledStore site(*site_);
  // A report comes while each piece is committed, and waits until it is.
  std::string events;
  site.on_retire = [&](std::span<const Uuid> reports) {
    events += std::to_string(reports.size()) + " ";
  };
  options_.queued_reports = [&]() -> std::size_t {
    if (!events.ends_with("10 "))
      return 0;
    events += "report, ";
    return 1;
  };
  options_.exchange.down.retirements = 10;
  {
    Forwarder forwarder(site, options_);
    ASSERT_TRUE(comes_true([&] { return paths_of(*memory_) == kPaths; }));
    ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == kPaths; }));
    ASSERT_TRUE(memory_->reset_task("shelf"));
    ASSERT_TRUE(comes_true([&] { return paths_of(*site_) == 0; }));
    ASSERT_TRUE(comes_true([&] { return status(forwarder).retired_here == kPaths; }));
  }
  EXPECT_TRUE(events.starts_with("10 report, 10 report, 10 ")) << events;
}

TEST_F(ForwarderTest, RestsAsLongAsItIsTold) {
  constexpr auto kCommit = 5ms;  // of a slow disk
  constexpr std::uint64_t kReports = 4;
  options_.rest = 20;
  options_.hooks.tasks_in_use = [] { return std::set<std::string>{"shelf"}; };
  options_.hooks.commit = [&](std::vector<store::ReplicatedReport> reports,
                              store::Store::ReportsDone done) {
    std::this_thread::sleep_for(kCommit);
    site_->commit_replicated(std::move(reports), std::move(done));
  };
  options_.exchange.down = {.reports = 1, .commit = 1};
  ASSERT_TRUE(memory_->register_robot(panda_));
  for (std::uint64_t number = 1; number <= kReports; ++number)
    test::report(*memory_, {solved(number)});
  const auto began = std::chrono::steady_clock::now();
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return site_->status().attempts == kReports; }));
  EXPECT_GE(std::chrono::steady_clock::now() - began, (kReports - 1) * 20 * kCommit);
}

TEST_F(ForwarderTest, WhoReportsWithoutAPauseDoesNotKeepItForEver) {
  options_.queued_reports = [] { return std::size_t{1}; };
  test::report(*site_, {solved(1)});
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 1; }));
  test::report(*site_, {solved(2)});
  forwarder.wake();
  ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 2; }));
}

TEST_F(ForwarderTest, TasksThatWereUsedWhileCutOffComeDownAfterARestart) {
  ASSERT_TRUE(memory_->register_robot(panda_));
  test::report(*memory_, {solved(11)});
  options_.first_retry = options_.longest_retry = 1h;  // what is noted is so at once
  is_cut_ = true;
  {
    std::atomic<bool> is_used = false;
    options_.hooks.tasks_in_use = [&] {
      return is_used ? std::set<std::string>{"shelf"} : std::set<std::string>();
    };
    Forwarder forwarder(*site_, options_);
    ASSERT_TRUE(comes_true([&] { return status(forwarder).tries == 1; }));
    is_used = true;
    forwarder.wake_for_task();
    ASSERT_TRUE(comes_true([&] { return status(forwarder).tasks == 1; }));
  }
  options_.hooks.tasks_in_use = [] { return std::set<std::string>(); };
  is_cut_ = false;
  const Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return site_->status().attempts == 1; })) << "nobody asks again";
}

TEST_F(ForwarderTest, WhoStopsEndsWhatWaitsForTheMemory) {
  std::promise<void> is_given_up;
  std::promise<void> is_asked;
  options_.open = [&]() -> std::unique_ptr<store::Store> {
    auto connection = std::make_unique<store::TroubledStore>(*memory_);
    // As one that never answers.
    connection->on_exchange = [&] {
      is_asked.set_value();
      is_given_up.get_future().wait();
      throw Failure(ErrorCode::Unavailable, "given up");
    };
    connection->on_stop_waiting = [&] { is_given_up.set_value(); };
    return connection;
  };
  test::report(*site_, {solved(1)});
  Forwarder forwarder(*site_, options_);
  is_asked.get_future().wait();
  forwarder.stop();
  EXPECT_EQ(status(forwarder).sent, 0U);
}

TEST(Backoff, GrowsToItsLimitAtRandom) {
  Backoff backoff(100ms, 1000ms, 3);
  std::set<std::chrono::milliseconds> waits;
  auto limit = 100ms;
  for (int i = 0; i < 20; ++i) {
    const auto wait = backoff.next();
    EXPECT_LE(wait, limit);
    EXPECT_GE(2 * wait + 1ms, limit);
    limit = std::min(2 * limit, 1000ms);
    waits.insert(wait);
  }
  EXPECT_GT(waits.size(), 10U);
  backoff.reset();
  EXPECT_LE(backoff.next(), 100ms);
}

}  // namespace
}  // namespace kinship::sites
