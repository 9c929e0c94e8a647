#include "proto/evidence/machine_speed.hpp"

#include <gtest/gtest.h>

#include <ctime>

namespace kinship::evidence::machine_speed_test {
namespace {

double thread_s() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

TEST(MachineSpeed, IsMeasuredOnceAndBrieflyAndWithinItsLimits) {
  const double begin_s = thread_s();
  const double speed = machine_speed();
  const double end_s = thread_s();
  EXPECT_GT(speed, 1e-3);
  EXPECT_LT(speed, 1e3);
  EXPECT_GT(end_s - begin_s, 0.3e-3) << "the first call measures";
  EXPECT_LT(end_s - begin_s, 20e-3) << "less than 1 ms, but for a sanitizer";
  EXPECT_EQ(machine_speed(), speed);
  EXPECT_LT(thread_s() - end_s, 0.2e-3) << "and no other one does";
}

}  // namespace
}  // namespace kinship::evidence::machine_speed_test
