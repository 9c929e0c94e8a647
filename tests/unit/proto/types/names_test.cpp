#include "proto/types/names.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship::names_test {
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

TEST(Names, ACutTextIsNeverCutInsideACharacter) {
  const std::string text = "a\xC3\xA9\xE2\x82\xAC\xF0\x9F\xA4\x96";  // 1, 2, 3 and 4 bytes
  const std::size_t expected[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 10};
  for (std::size_t most = 0; most < std::size(expected); ++most)
    EXPECT_EQ(cut_text(text, most), text.substr(0, expected[most])) << most;
}

TEST(Names, ACutTextMayAlwaysBeSent) {
  EXPECT_EQ(cut_text("a\x01"
                     "b\x7F\tc\nd",
                     99),
            "a?b?\tc\nd");
  EXPECT_EQ(cut_text("no UTF-8: \xFF, \xC3", 99), "no UTF-8: ?, ?");
  EXPECT_FALSE(check_text("message", cut_text("\x80\xE2\x82\x02", 99), 99));
}

}  // namespace
}  // namespace kinship::names_test
