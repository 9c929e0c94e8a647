#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <thread>

#include "tests/faults/store_session.hpp"
#include "tests/support/long_run.hpp"

/// A disk that fails at any one call of a session, once or for some calls: reports are answered
/// TryAgain, the store opens itself again and goes on, readings are right or say that they failed.
/// KINSHIP_LONG=1 fails each call, else every few.
namespace kinship::store::store_disk_failures_test {
namespace {

using Clock = std::chrono::steady_clock;
using test::DiskCall;
using test::DiskFault;
using test::StoreSession;

constexpr std::uint64_t kSeed = 20261123;
constexpr std::uint64_t kDistribution = 7;
constexpr auto kTooLong = std::chrono::seconds(5);  // of what takes milliseconds

std::uint64_t stride(std::uint64_t short_run) { return test::is_long_run() ? 1 : short_run; }

/// What a client does that was told of a failure of the storage: the same again.
template <typename Work>
void patiently(Work work) {
  constexpr int kPatience = 100'000;
  for (int again = 0;; ++again) {
    try {
      work();
      return;
    } catch (const Failure& failure) {
      if (failure.code() != ErrorCode::Storage || again == kPatience)
        throw;
    }
  }
}

/// Reads as a fit and a fetch do, until it is destroyed.
class Reading {
 public:
  explicit Reading(const Store& store) : store_(&store), thread_([this] { run(); }) {}
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading() {
    stopping_ = true;
    thread_.join();
    EXPECT_EQ(wrong_, 0U);
    EXPECT_LT(longest_, kTooLong);
  }

 private:
  void run() {
    while (!stopping_) {
      const Clock::time_point start = Clock::now();
      try {
        read();
      } catch (const Failure& failure) {
        if (failure.code() != ErrorCode::Storage)
          ++wrong_;
      }
      longest_ = std::max(longest_, Clock::now() - start);
    }
  }

  void read() {
    for (const RobotRecord& robot : test::ledger_robots())
      for (const StoredPath& path :
           store_->read_paths(robot.digest, "stack", {.after_id = 0, .limit = 1000})) {
        const auto found = numbers_.find(path.report_uuid);
        if (found == numbers_.end() ||
            path.path.waypoints() != test::ledger_attempt(found->second).path->waypoints())
          ++wrong_;
      }
    const auto distribution = store_->find_distribution(test::id_from<Digest>(kDistribution));
    if (distribution && distribution->task != "stack")
      ++wrong_;
  }

  static std::map<Uuid, std::uint64_t> all_numbers() {
    std::map<Uuid, std::uint64_t> numbers;
    for (std::uint64_t number = 0; number < 100; ++number)
      numbers[test::ledger_attempt(number).report_uuid] = number;
    return numbers;
  }

  const Store* store_;
  const std::map<Uuid, std::uint64_t> numbers_ = all_numbers();
  std::atomic<bool> stopping_ = false;
  std::size_t wrong_ = 0;
  Clock::duration longest_{};
  std::thread thread_;
};

enum class Beginning { Nothing, AStore };

/// Opens, registers, reports so that checkpoints happen, closes; all of it in spite of `fault`.
/// \return whether the fault came to pass.
bool fails_without_loss(const DiskFault& fault, Beginning beginning = Beginning::Nothing) {
  StoreSession session(kSeed, beginning == Beginning::AStore ? 30 : 300);
  if (beginning == Beginning::AStore)
    session.register_robots(*session.open());
  session.disk().fail(fault);
  std::unique_ptr<Store> store;
  patiently([&] { store = session.open(); });
  {
    const Reading reading(*store);
    patiently([&] { session.register_robots(*store); });
    const Clock::time_point start = Clock::now();
    session.report(*store, 2, 9);
    EXPECT_LT(Clock::now() - start, kTooLong);
    patiently([&] { session.put_distribution(*store, kDistribution); });
  }
  const bool failed = session.disk().failed() > 0;
  session.disk().fail({.count = 0});
  EXPECT_EQ(test::find_loss(*store, session.ledger().receipts()), "");
  store.reset();
  for (const std::string& loss : session.find_losses())
    ADD_FAILURE() << loss;
  return failed;
}

/// Fails the calls of one kind one after the other, until a session has no more of them.
void fail_each(unsigned calls, int error, std::uint64_t step) {
  std::uint64_t sessions = 0;
  for (const std::uint64_t count : {1U, 4U, 40U}) {
    std::uint64_t first = count % step;
    while (fails_without_loss({.calls = calls, .first = first, .count = count, .error = error})) {
      ++sessions;
      ASSERT_FALSE(testing::Test::HasFailure())
          << count << " calls fail from call " << first << " on";
      first += step;
    }
  }
  testing::Test::RecordProperty("sessions", static_cast<int>(sessions));
  EXPECT_GT(sessions, 3U);
}

TEST(StoreDiskFailures, AWriteThatFails) {
  fail_each(static_cast<unsigned>(DiskCall::Write), EIO, stride(37));
}
TEST(StoreDiskFailures, AWriteThatFindsNoRoom) {
  fail_each(static_cast<unsigned>(DiskCall::Write), ENOSPC, stride(41));
}
// Not of the directory: SQLite drops that error, so a new store is in danger until it is made.
TEST(StoreDiskFailures, ASyncThatFails) {
  fail_each(static_cast<unsigned>(DiskCall::Sync), EIO, stride(4));
}
// Without its name in the directory the WAL is lost with all that it has.
TEST(StoreDiskFailures, ASyncOfTheDirectoryThatFails) {
  const auto calls = static_cast<unsigned>(DiskCall::SyncDirectory);
  std::uint64_t first = 0;
  while (fails_without_loss({.calls = calls, .first = first}, Beginning::AStore))
    ++first;
  EXPECT_GT(first, 1U);
}
TEST(StoreDiskFailures, ATruncationThatFails) {
  fail_each(static_cast<unsigned>(DiskCall::Truncate), EIO, 1);
}
TEST(StoreDiskFailures, ANameThatCannotBeChanged) {
  fail_each(static_cast<unsigned>(DiskCall::Name), EIO, 1);
}

}  // namespace
}  // namespace kinship::store::store_disk_failures_test
