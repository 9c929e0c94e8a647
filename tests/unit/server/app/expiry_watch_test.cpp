#include "server/app/expiry_watch.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace kinship::app::expiry_watch_test {
namespace {

using std::chrono::days;
using std::chrono::hours;
using TimePoint = ExpiryWatch::TimePoint;

TEST(ExpiryWatch, TellsOnceADayFromThirtyDaysBeforeTheEnd) {
  const std::chrono::sys_seconds end{std::chrono::seconds(2'000'000'000)};
  const TimePoint start{hours(1000)};
  std::chrono::sys_seconds wall = end - days(31);
  std::vector<std::string> told;
  ExpiryWatch watch(
      security::Credentials{.name = "server", .role = "server", .expires = end},
      [&] { return wall; }, [&](std::string_view words) { told.emplace_back(words); });
  const auto call_at = [&](hours since_start) {
    wall = end - days(31) + since_start;
    return watch.beat(start + since_start);
  };
  EXPECT_EQ(call_at(hours(0)), start + hours(24)) << "nobody has to call before";
  EXPECT_TRUE(told.empty());
  EXPECT_EQ(call_at(hours(24)), start + hours(48));
  EXPECT_TRUE(told.empty()) << "30 days left";
  for (int minute = 1; minute <= 10; ++minute)
    call_at(hours(48));
  ASSERT_EQ(told.size(), 1U) << "the loop wakes often";
  EXPECT_NE(told[0].find("'server' expire in 29 days"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("kinshipd secure renew-server"), std::string::npos) << told[0];
  call_at(hours(71));
  EXPECT_EQ(told.size(), 1U);
  call_at(hours(72));
  EXPECT_EQ(told.size(), 2U);
  call_at(days(32));
  EXPECT_NE(told.back().find("have expired"), std::string::npos) << told.back();
}

TEST(ExpiryWatch, WithoutCredentialsThereIsNothingToWaitFor) {
  ExpiryWatch watch(
      std::nullopt, [] { return std::chrono::sys_seconds(); }, [](std::string_view) { FAIL(); });
  EXPECT_EQ(watch.beat(TimePoint()), TimePoint::max());
}

}  // namespace
}  // namespace kinship::app::expiry_watch_test
