#include "server/service/store_watch.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::service::store_watch_test {
namespace {

std::ptrdiff_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

/// A store of several servers, in which something changes between any two looks: what is behind
/// cursor n is called n, and n + 1 is the next one.
class StoreWatchTest : public testing::Test {
 protected:
  StoreWatchTest() {
    store_.on_changes = [this](std::string_view cursor) -> std::optional<store::StoreChanges> {
      const std::lock_guard lock(mutex_);
      asked_.emplace_back(cursor);
      if (asked_.size() == failing_look_)
        throw Failure(ErrorCode::Storage, "the database does not answer");
      store::StoreChanges changes;
      changes.cursor = cursor.empty() ? "1" : std::to_string(std::stoi(std::string(cursor)) + 1);
      changes.experience.push_back({.task = std::string(cursor), .now = {}});
      return changes;
    };
  }

  void take(const store::StoreChanges& changes) {
    const std::lock_guard lock(mutex_);
    told_.push_back(changes.experience.at(0).task);
    changed_.notify_all();
    if (told_.size() == failing_take_)
      throw Failure(ErrorCode::Storage, "a robot cannot be read now");
  }
  std::vector<std::string> told(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return told_.size() >= count; });
    return {told_.begin(), told_.begin() + static_cast<std::ptrdiff_t>(count)};
  }

  const test::TemporaryDirectory directory_;
  const std::unique_ptr<store::Store> real_ = store::open_sqlite_store(directory_ / "fleet.db");
  store::TroubledStore store_{*real_};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t failing_look_ = 0, failing_take_ = 0;  // from 1; guarded by mutex_, as what follows
  std::vector<std::string> asked_, told_;
};

using Names = std::vector<std::string>;

TEST_F(StoreWatchTest, TellsWhatCameSinceTheLastLookEachOnce) {
  StoreWatch watch(store_, [this](const store::StoreChanges& changes) { take(changes); });
  EXPECT_EQ(told(3), (Names{"1", "2", "3"})) << "what was there before is in nobody's memory";
  watch.stop();
  EXPECT_EQ(asked_[0], "");
}

TEST_F(StoreWatchTest, AStoreThatCannotBeAskedIsAskedTheSameAgain) {
  failing_look_ = 3;
  StoreWatch watch(store_, [this](const store::StoreChanges& changes) { take(changes); });
  EXPECT_EQ(told(2), (Names{"1", "2"}));
  watch.stop();
  EXPECT_EQ((Names{asked_.begin(), asked_.begin() + 4}), (Names{"", "1", "2", "2"}));
}

TEST_F(StoreWatchTest, WhatCouldNotBeTakenIsToldAgain) {
  failing_take_ = 1;
  StoreWatch watch(store_, [this](const store::StoreChanges& changes) { take(changes); });
  EXPECT_EQ(told(3), (Names{"1", "1", "2"}));
}

TEST_F(StoreWatchTest, AStoreThatCannotBeAskedAtTheBeginningIsAnError) {
  failing_look_ = 1;
  EXPECT_THROW(StoreWatch(store_, [](const store::StoreChanges&) {}), Failure);
}

TEST_F(StoreWatchTest, AServerThatHasItsStoreToItselfHasNoThreadForIt) {
  store_.on_changes = nullptr;
  const std::ptrdiff_t before = threads();
  StoreWatch watch(store_, [](const store::StoreChanges&) { ADD_FAILURE() << "told"; });
  EXPECT_EQ(threads(), before);
  watch.stop();
}

TEST_F(StoreWatchTest, AfterAStopNothingIsToldAndItDoesNotWaitForTheNextLook) {
  constexpr int kWatches = 20;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kWatches; ++i) {
    std::size_t before = 0;
    {
      const std::lock_guard lock(mutex_);
      before = told_.size();
    }
    StoreWatch watch(store_, [this](const store::StoreChanges& changes) { take(changes); });
    static_cast<void>(told(before + 1));
    watch.stop();
    watch.stop();
    EXPECT_EQ(told_.size(), asked_.size() - 1 - static_cast<std::size_t>(i));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kWatches * StoreWatch::kInterval / 2);
}

}  // namespace
}  // namespace kinship::service::store_watch_test
