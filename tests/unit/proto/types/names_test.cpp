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

TEST(Names, MachineMustBeUtf8) {
  EXPECT_EQ(check_machine("\xff")->message, "machine: is not UTF-8");
}

TEST(Names, TextMayHaveLinesButNoOtherControlCharacters) {
  EXPECT_FALSE(check_text("reason", "one\n\ttwo\r\n", 100));
  EXPECT_TRUE(check_text("reason", std::string(1, '\0'), 100));
  EXPECT_EQ(check_text("reason", "four", 3)->message, "reason: 4 bytes exceed 3");
}

TEST(Utf8, AcceptsTheEdgesOfEveryLength) {
  for (const char* text : {"", "\x7f", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
                           "\xee\x80\x80", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_TRUE(is_utf8(text)) << text;
}

TEST(Utf8, RefusesOverlongSurrogatesTruncatedAndTooLarge) {
  for (const char* text :
       {"\x80", "\xc0\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf",
        "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "a\xe2\x82", "\xc3", "\xc3("})
    EXPECT_FALSE(is_utf8(text));
}

}  // namespace
}  // namespace kinship
