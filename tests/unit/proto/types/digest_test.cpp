#include "proto/types/digest.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/types/sha256.hpp"

namespace kinship::digest_test {
namespace {

TEST(Digest, RoundTripsThroughHex) {
  Digest digest;
  for (std::size_t i = 0; i < digest.bytes.size(); ++i)
    digest.bytes[i] = static_cast<std::uint8_t>(7 * i + 200);
  EXPECT_EQ(Digest::from_hex(digest.hex()), digest);
}

TEST(Digest, RefusesOtherLengthsAndDigits) {
  EXPECT_FALSE(Digest::from_hex(std::string(63, 'a')));
  EXPECT_FALSE(Digest::from_hex(std::string(63, 'a') + "g"));
}

TEST(Sha256, MatchesThePublishedVector) {  // FIPS 180-4, "abc"
  const std::array<std::uint8_t, 3> abc = {'a', 'b', 'c'};
  EXPECT_EQ(Sha256().add(std::span<const std::uint8_t>(abc)).finish().hex(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, TextsDoNotRunIntoEachOther) {
  EXPECT_NE(Sha256().add(std::string_view("ab")).add(std::string_view("c")).finish(),
            Sha256().add(std::string_view("a")).add(std::string_view("bc")).finish());
}

TEST(Sha256, NegativeZeroCountsAsZero) {
  EXPECT_EQ(Sha256().add(-0.0).finish(), Sha256().add(0.0).finish());
}

}  // namespace
}  // namespace kinship::digest_test
