#include "server/store/values/crc32c.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <vector>

namespace kinship::store::crc32c_test {
namespace {

TEST(Crc32c, MatchesThePublishedVectors) {  // RFC 3720, appendix B.4, and the usual check value
  const std::vector<std::uint8_t> zeros(32, 0);
  std::vector<std::uint8_t> ascending(32);
  std::iota(ascending.begin(), ascending.end(), std::uint8_t{0});
  const std::vector<std::uint8_t> digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc32c(zeros), 0x8A9136AAU);
  EXPECT_EQ(crc32c(ascending), 0x46DD794EU);
  EXPECT_EQ(crc32c(digits), 0xE3069283U);
  EXPECT_EQ(crc32c({}), 0U);
}

TEST(Crc32c, OfTwoPartsIsThatOfTheWhole) {
  std::mt19937 generator(1);
  std::vector<std::uint8_t> bytes(101);
  for (std::uint8_t& byte : bytes)
    byte = static_cast<std::uint8_t>(generator());
  const std::span<const std::uint8_t> all(bytes);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut)
    EXPECT_EQ(crc32c(all.subspan(cut), crc32c(all.first(cut))), crc32c(all)) << cut;
}

TEST(Crc32c, OfTheInstructionIsThatOfTheTables) {
  std::mt19937 generator(2);
  std::vector<std::uint8_t> bytes(4099);
  for (std::uint8_t& byte : bytes)
    byte = static_cast<std::uint8_t>(generator());
  const std::span<const std::uint8_t> all(bytes);
  for (std::size_t size = 0; size <= bytes.size(); size += 7)
    EXPECT_EQ(crc32c(all.first(size), 5), crc32c_by_tables(all.first(size), 5)) << size;
}

TEST(Crc32c, FindsEveryFlippedBit) {
  std::vector<std::uint8_t> bytes(200, 0x5A);
  const std::uint32_t crc = crc32c(bytes);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_NE(crc32c(bytes), crc) << bit;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
}

}  // namespace
}  // namespace kinship::store::crc32c_test
