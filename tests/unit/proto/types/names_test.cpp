#include "proto/types/names.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship {
namespace {

TEST(Names, TaskNeedsItsCharacterSet) {
  EXPECT_FALSE(check_task("bin_to_shelf:v1.2-a"));
  EXPECT_TRUE(check_task(""));
  const auto error = check_task("bin to shelf");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, "task: byte 4 is not one of A-Z a-z 0-9 _ . : -");
}

TEST(Names, LengthsAreLimited) {
  EXPECT_FALSE(check_task(std::string(128, 'a')));
  EXPECT_TRUE(check_task(std::string(129, 'a')));
  EXPECT_TRUE(check_label(std::string(65, 'a')));
}

TEST(Names, MachineMayBeAnythingPrintable) {
  EXPECT_FALSE(check_machine("Zelle 3, Halle Süd"));
  EXPECT_FALSE(check_machine(""));
  EXPECT_TRUE(check_machine("cell\n3"));
}

}  // namespace
}  // namespace kinship
