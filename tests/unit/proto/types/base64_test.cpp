#include "proto/types/base64.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinship::base64_test {
namespace {

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

TEST(Base64, IsThatOfTheRfc) {  // RFC 4648, section 10
  EXPECT_EQ(to_base64(bytes_of("")), "");
  EXPECT_EQ(to_base64(bytes_of("f")), "Zg==");
  EXPECT_EQ(to_base64(bytes_of("fo")), "Zm8=");
  EXPECT_EQ(to_base64(bytes_of("foobar")), "Zm9vYmFy");
}

TEST(Base64, ComesBackWhateverItIs) {
  std::mt19937 generator(7);
  for (const std::size_t size : std::vector<std::size_t>{0, 1, 2, 3, 4, 1000, 393'216}) {
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>(generator());
    EXPECT_EQ(from_base64(to_base64(bytes)), bytes) << size;
  }
}

TEST(Base64, WhatIsNoneIsNotRead) {
  for (const char* text :
       {"Zg=", "Zg", "Z===", "====", "Zg==Zg==", "Z g=", " Zg=", "Zm9*", "Zg==\n"})
    EXPECT_FALSE(from_base64(text)) << text;
}

}  // namespace
}  // namespace kinship::base64_test
