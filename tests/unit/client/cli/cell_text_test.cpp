#include "client/cli/cell_text.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace kinship::cli::cell_text_test {
namespace {

TEST(AgeText, HasOneUnit) {
  constexpr std::int64_t kNow_ms = 1'795'226'587'000;
  const auto age = [](std::int64_t seconds) { return age_text(kNow_ms - 1000 * seconds, kNow_ms); };
  EXPECT_EQ(age(0), "0s");
  EXPECT_EQ(age(119), "119s");
  EXPECT_EQ(age(120), "2m");
  EXPECT_EQ(age(7200), "2h");
  EXPECT_EQ(age(86'400 * 3), "3d");
  EXPECT_EQ(age(-5), "0s") << "of a machine whose clock is ahead";
  EXPECT_EQ(age_text(0, kNow_ms), "-");
}

TEST(SizeText, HasOneDigitBehindThePoint) {
  EXPECT_EQ(size_text(999), "999 B");
  EXPECT_EQ(size_text(1234), "1.2 kB");
  EXPECT_EQ(size_text(3'400'000'000), "3.4 GB");
}

TEST(ShortPoseText, IsWhatPlacementTakes) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.5, -0.25, 10;
  EXPECT_EQ(short_pose_text(T), "0.5 -0.25 10 0 0 0 1");
}

}  // namespace
}  // namespace kinship::cli::cell_text_test
