#include "server/console/figures.hpp"

#include <gtest/gtest.h>

#include "server/service/service.hpp"
#include "server/store/open_store.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::console::figures_test {
namespace {

using std::chrono::seconds;

/// Returns in another millisecond, so that what is made anew says another time.
void await_next_millisecond() {
  using std::chrono::milliseconds;
  const auto now = [] {
    return std::chrono::floor<milliseconds>(std::chrono::system_clock::now());
  };
  for (const auto begin = now(); now() == begin;) {
  }
}

TEST(Figures, OfRecentAttemptsAreKeptForAHundredTimesAsLongAsTheyTook) {
  const test::TemporaryDirectory folder;
  service::Service service(store::open_store((folder.path() / "store.db").string(), {}), {});
  Questions questions(service.administration(), false);
  Figures::Clock::time_point time{};
  seconds takes{1};  // each look at the clock
  Figures figures(questions, [&] { return time += takes; });
  const std::string first = figures.make("slow", "24");
  takes = seconds{0};
  await_next_millisecond();
  EXPECT_EQ(figures.make("slow", "24"), first);
  time += seconds(99);
  EXPECT_EQ(figures.make("slow", "24"), first);
  EXPECT_NE(figures.make("slow", "25"), first) << "another one";
  time += seconds(2);
  EXPECT_NE(figures.make("slow", "24"), first);
  EXPECT_THROW(figures.make("task", "none"), Failure);
  service.shutdown();
}

TEST(Figures, ManyKeptOnesMakeRoom) {
  const test::TemporaryDirectory folder;
  service::Service service(store::open_store((folder.path() / "store.db").string(), {}), {});
  Questions questions(service.administration(), false);
  Figures::Clock::time_point time{};
  Figures figures(questions, [&] { return time += seconds(1); });
  const std::string first = figures.make("savings", "1");
  for (int hours = 2; hours < 30; ++hours)
    figures.make("savings", std::to_string(hours));
  await_next_millisecond();
  EXPECT_NE(figures.make("savings", "1"), first);
  service.shutdown();
}

}  // namespace
}  // namespace kinship::console::figures_test
