#include "proto/types/digest.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

#include "proto/types/base64.hpp"
#include "proto/types/sha256.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::identities_test {
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

TEST(Uuid, RoundTripsThroughText) {
  const Uuid uuid = Uuid::random();
  EXPECT_EQ(Uuid::parse(uuid.text()), uuid);
  EXPECT_EQ(uuid.text().size(), 36U);
  EXPECT_EQ(uuid.text()[14], '4');
}

TEST(Uuid, RandomOnesDiffer) {
  std::set<Uuid> seen;
  for (int i = 0; i < 1000; ++i)
    seen.insert(Uuid::random());
  EXPECT_EQ(seen.size(), 1000U);
}

TEST(Uuid, RefusesOtherForms) {
  EXPECT_FALSE(Uuid::parse(""));
  EXPECT_FALSE(Uuid::parse("00000000000000000000000000000000"));
  EXPECT_FALSE(Uuid::parse("00000000-0000-4000-8000-00000000000x"));
  EXPECT_FALSE(Uuid::parse("000000000-000-4000-8000-000000000000"));
}

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
}  // namespace kinship::identities_test
