#include "proto/types/duration_text.hpp"

#include <gtest/gtest.h>

namespace kinship::duration_text_test {
namespace {

TEST(DurationText, HasThreeDigitsInTheUnitThatFits) {
  EXPECT_EQ(duration_text(0), "0 s");
  EXPECT_EQ(duration_text(2.5), "2.50 s");
  EXPECT_EQ(duration_text(75.04), "75.0 s");
  EXPECT_EQ(duration_text(1234.5), "1234 s");
  EXPECT_EQ(duration_text(0.4123), "412 ms");
  EXPECT_EQ(duration_text(0.00312), "3.12 ms");
  EXPECT_EQ(duration_text(85.12e-6), "85.1 µs");
  EXPECT_EQ(duration_text(4e-8), "0.04 µs");
}

TEST(DurationText, RoundsIntoTheNextUnit) {
  EXPECT_EQ(duration_text(0.99951), "1.00 s");
  EXPECT_EQ(duration_text(0.9994), "999 ms");
  EXPECT_EQ(duration_text(0.0099951), "10.0 ms");
}

}  // namespace
}  // namespace kinship::duration_text_test
