#include "proto/types/time_text.hpp"

#include <gtest/gtest.h>

namespace kinship::time_text_test {
namespace {

TEST(TimeText, IsUtcToTheSecond) {
  EXPECT_EQ(time_text(std::int64_t{0}), "1970-01-01T00:00:00Z");
  EXPECT_EQ(time_text(std::int64_t{1'795'226'587'999}), "2026-11-21T02:03:07Z");
  EXPECT_EQ(time_text(std::chrono::sys_seconds(std::chrono::seconds(1'795'226'587))),
            "2026-11-21T02:03:07Z");
}

TEST(TimeText, BeforeNineteenSeventyRoundsDownToo) {
  EXPECT_EQ(time_text(std::int64_t{-1}), "1969-12-31T23:59:59Z");
}

}  // namespace
}  // namespace kinship::time_text_test
