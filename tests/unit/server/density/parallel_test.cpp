#include "server/density/parallel.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <barrier>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace kinship::density::parallel_test {
namespace {

TEST(ForEachPart, DoesEachPartOnce) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> done(100);
    for_each_part(threads, 100, [&](int part) { ++done[static_cast<std::size_t>(part)]; });
    for (const auto& count : done)
      EXPECT_EQ(count, 1);
  }
  for_each_part(3, 0, [](int /*part*/) { FAIL(); });
}

TEST(ForEachPart, PartsMayHavePartsThemselves) {
  for (int round = 0; round < 200; ++round) {
    std::vector<std::atomic<int>> done(24);
    for_each_part(2, 3, [&](int outer) {
      for_each_part(3, 4, [&](int middle) {
        for_each_part(2, 2, [&](int inner) {
          const int place = 8 * outer + 2 * middle + inner;
          ++done[static_cast<std::size_t>(place)];
        });
      });
    });
    for (const auto& count : done)
      ASSERT_EQ(count, 1);
  }
}

/// Who helps takes longer than who called: who returned before would find a part undone.
TEST(ForEachPart, NothingIsLeftWhenItReturns) {
  const std::thread::id caller = std::this_thread::get_id();
  for (int round = 1; round <= 200; ++round) {
    std::atomic<bool> is_helped = false;
    std::vector<std::atomic<int>> done(8);
    for_each_part(2, 8, [&](int part) {
      if (std::this_thread::get_id() == caller) {
        while (!is_helped)
          std::this_thread::yield();
      } else {
        is_helped = true;
        for (int i = 0; i < 1000; ++i)
          std::this_thread::yield();
      }
      done[static_cast<std::size_t>(part)] = round;
    });
    for (const auto& value : done)
      ASSERT_EQ(value, round);
  }
}

TEST(ForEachPart, ThrowsWhatTheFirstFailingPartThrew) {
  for (const int threads : {1, 4}) {
    std::atomic<int> done = 0;
    try {
      for_each_part(threads, 50, [&](int part) {
        ++done;
        if (part == 7 || part == 30)
          throw std::runtime_error("part " + std::to_string(part));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "part 7");
    }
    EXPECT_EQ(done, 50);
  }
}

/// Threads are not begun anew for each work, of which a fit has thousands.
TEST(ForEachPart, KeepsItsThreads) {
  constexpr int kThreads = 4;
  std::mutex mutex;
  std::set<pid_t> seen;
  std::jthread([&] {  // that has no helpers yet
    for (int work = 0; work < 20; ++work) {
      std::barrier all(kThreads);
      for_each_part(kThreads, kThreads, [&](int /*part*/) {
        all.arrive_and_wait();  // so that each part has a thread of its own
        const std::lock_guard lock(mutex);
        seen.insert(gettid());
      });
    }
  })
      .join();
  EXPECT_EQ(seen.size(), kThreads);
}

}  // namespace
}  // namespace kinship::density::parallel_test
