#include "proto/types/number_text.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

namespace kinship::number_text_test {
namespace {

TEST(NumberText, IsShortAndReadsBack) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(-3), "-3");
  for (const double value : {1.0 / 3, -1e-300, std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::denorm_min()})
    EXPECT_EQ(std::strtod(number_text(value).c_str(), nullptr), value);
}

TEST(NumberText, NamesWhatIsNotFinite) {
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN()), "nan");
}

}  // namespace
}  // namespace kinship::number_text_test
