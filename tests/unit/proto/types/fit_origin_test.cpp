#include "proto/types/fit_origin.hpp"

#include <gtest/gtest.h>

namespace kinship::fit_origin_test {
namespace {

TEST(FitOrigin, SaysWhichOfTheTwoHappened) {
  EXPECT_EQ(describe({4, 2, 525, 25, 25, ""}), "incremental from revision 4, 25 of 525 paths new");
  EXPECT_EQ(describe({4, 2, 525, 25, 525, ""}),
            "incremental from revision 4, 25 of 525 paths new, 525 transferred");
  EXPECT_EQ(describe({0, 0, 500, 500, 500, "the first"}), "full (the first), 500 paths");
  EXPECT_EQ(describe({0, 0, 40, 40, 20, ""}), "full, 40 paths, 20 transferred");
}

}  // namespace
}  // namespace kinship::fit_origin_test
