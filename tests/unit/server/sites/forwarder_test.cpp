#include "server/sites/forwarder.hpp"

#include <atomic>
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
  }
  test::report(*site_, {solved(2)});
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return reports_of(*memory_).size() == 2; }));
  ASSERT_TRUE(comes_true([&] { return status(forwarder).sent == 1; })) << "the first is not sent";
}

TEST_F(ForwarderTest, StopsWhileTheMemoryDoesNotAnswer) {
  std::atomic<bool> is_asked = false;
  options_.open = [&]() -> std::unique_ptr<store::Store> {
    auto connection = std::make_unique<store::TroubledStore>(*memory_);
    connection->on_commit = [&](const std::vector<store::SharedReport>&,
                                const store::Store::ReportsDone&) { is_asked = true; };
    return connection;
  };
  test::report(*site_, {solved(1)});
  Forwarder forwarder(*site_, options_);
  ASSERT_TRUE(comes_true([&] { return is_asked.load(); }));
  forwarder.stop();
  EXPECT_EQ(status(forwarder).waiting, 1U);
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
