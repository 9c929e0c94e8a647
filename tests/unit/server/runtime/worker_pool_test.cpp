#include "server/runtime/worker_pool.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "proto/types/failure.hpp"

namespace kinship::runtime::worker_pool_test {
namespace {

using Priority = WorkerPool::Priority;

/// A pool whose only thread is held until the gate opens.
class HeldPool : public testing::Test {
 protected:
  HeldPool() {
    std::promise<void> begun;
    pool_.submit(Priority::Interactive, {.run =
                                             [this, &begun] {
                                               begun.set_value();
                                               gate_.get_future().wait();
                                             },
                                         .abandon = {}});
    begun.get_future().wait();
  }
  void open() { gate_.set_value(); }
  WorkerPool::Job note(char name) {
    return {.run = [this, name] { order_ += name; }, .abandon = [this] { ++abandoned_; }};
  }

  std::promise<void> gate_;
  std::string order_;
  int abandoned_ = 0;
  WorkerPool pool_{{.threads = 1, .queue_limit = 4, .niceness = 0}};
};

TEST_F(HeldPool, AJobThatFindsNoMemoryIsDroppedAndTheNextOneRuns) {
  EXPECT_TRUE(
      pool_.submit(Priority::Interactive, {.run = [] { throw std::bad_alloc(); }, .abandon = {}}));
  EXPECT_TRUE(pool_.submit(Priority::Interactive, note('a')));
  open();
  pool_.stop(WorkerPool::Leftovers::Run);
  EXPECT_EQ(order_, "a");
}

TEST_F(HeldPool, InteractiveJobsGoFirstEachKindInOrder) {
  EXPECT_TRUE(pool_.submit(Priority::Background, note('c')));
  EXPECT_TRUE(pool_.submit(Priority::Interactive, note('a')));
  EXPECT_TRUE(pool_.submit(Priority::Background, note('d')));
  EXPECT_TRUE(pool_.submit(Priority::Interactive, note('b')));
  open();
  pool_.stop(WorkerPool::Leftovers::Run);
  EXPECT_EQ(order_, "abcd");
}

TEST_F(HeldPool, RefusesWhatExceedsTheQueue) {
  for (int i = 0; i < 4; ++i)
    EXPECT_TRUE(pool_.submit(Priority::Interactive, note('x')));
  EXPECT_EQ(pool_.queued(), 4U);
  EXPECT_FALSE(pool_.submit(Priority::Interactive, note('y')));
  open();
  pool_.stop(WorkerPool::Leftovers::Run);
  EXPECT_EQ(order_, "xxxx");
}

TEST_F(HeldPool, StopAbandonsWhatNobodyBeganOnRequest) {
  pool_.submit(Priority::Interactive, note('x'));
  // Abandoned last, while stop() has not yet begun to wait for the held thread.
  pool_.submit(Priority::Background, {.run = [this] { order_ += 'y'; },
                                      .abandon =
                                          [this] {
                                            ++abandoned_;
                                            open();
                                          }});
  pool_.stop(WorkerPool::Leftovers::Abandon);
  EXPECT_EQ(order_, "");
  EXPECT_EQ(abandoned_, 2);
}

TEST_F(HeldPool, AcceptsNothingOnceStopped) {
  open();
  pool_.stop(WorkerPool::Leftovers::Run);
  EXPECT_FALSE(pool_.submit(Priority::Interactive, note('x')));
}

TEST(WorkerPool, RunsEveryJobOfManySubmittersOnce) {
  std::atomic<int> runs = 0;
  WorkerPool pool({.threads = 3, .queue_limit = 10'000, .niceness = 0});
  std::vector<std::thread> submitters;
  submitters.reserve(4);
  for (int i = 0; i < 4; ++i)
    submitters.emplace_back([&] {
      for (int k = 0; k < 500; ++k)
        pool.submit(k % 2 == 0 ? Priority::Interactive : Priority::Background,
                    {.run = [&] { ++runs; }, .abandon = {}});
    });
  for (std::thread& submitter : submitters)
    submitter.join();
  pool.stop(WorkerPool::Leftovers::Run);
  EXPECT_EQ(runs, 2000);
}

TEST(WorkerPool, ThreadsRunAtTheirNicenessAndTheOthersKeepTheirs) {
  const int before = getpriority(PRIO_PROCESS, 0);
  std::promise<int> niceness;
  WorkerPool pool({.threads = 1, .queue_limit = 1, .niceness = 7});
  pool.submit(
      Priority::Interactive,
      {.run = [&] { niceness.set_value(getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()))); },
       .abandon = {}});
  EXPECT_EQ(niceness.get_future().get(), 7);
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), before);
}

#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)  // they need the addresses
/// The exit code of a process with room for a few threads that asks for many.
int ask_for_too_many_threads() {
  constexpr rlim_t kAddresses = rlim_t{256} << 20U;
  const rlimit room{kAddresses, kAddresses};
  if (setrlimit(RLIMIT_AS, &room) != 0)
    return 1;
  try {
    const WorkerPool pool({.threads = 1000, .queue_limit = 1, .niceness = 0});
  } catch (const Failure& failure) {
    return std::string(failure.what()).find("of 1000 threads") == std::string::npos ? 2 : 0;
  }
  return 3;
}

TEST(WorkerPool, MoreThreadsThanThereIsRoomForAreAFailure) {
  EXPECT_EXIT(_exit(ask_for_too_many_threads()), testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace kinship::runtime::worker_pool_test
