#include "server/app/signal_watcher.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <future>

namespace kinship::app::signal_watcher_test {
namespace {

TEST(SignalWatcher, PassesOnSignalsAlsoThoseHeldBefore) {
  hold_termination_signals();
  kill(getpid(), SIGTERM);  // would end the test
  std::promise<int> first, second, third;
  int calls = 0;
  const SignalWatcher watcher([&](int signal) {
    (++calls == 1 ? first : calls == 2 ? second : third).set_value(signal);
  });
  EXPECT_EQ(first.get_future().get(), SIGTERM);
  kill(getpid(), SIGINT);
  EXPECT_EQ(second.get_future().get(), SIGINT);
  kill(getpid(), SIGHUP);
  EXPECT_EQ(third.get_future().get(), SIGHUP);
}

TEST(SignalWatcher, EndsWithoutASignal) {
  const SignalWatcher watcher([](int) { FAIL(); });
}

}  // namespace
}  // namespace kinship::app::signal_watcher_test
