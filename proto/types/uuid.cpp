#include "proto/types/uuid.hpp"

#include <cstddef>
#include <cstring>
#include <random>

#include "proto/types/hex.hpp"

namespace kinship {
namespace {

constexpr std::size_t kTextLength = 36;
constexpr std::array<std::size_t, 4> kDashes = {8, 13, 18, 23};

}  // namespace

std::string Uuid::text() const {
  std::string text = to_hex(bytes);
  for (const std::size_t dash : kDashes)
    text.insert(dash, 1, '-');
  return text;
}

Uuid Uuid::random() {
  std::random_device source;  // getrandom(2) in libstdc++ on Linux
  Uuid uuid;
  for (std::size_t i = 0; i < uuid.bytes.size(); i += sizeof(std::uint32_t)) {
    const std::uint32_t word = source();
    std::memcpy(&uuid.bytes[i], &word, sizeof word);
  }
  uuid.bytes[6] = static_cast<std::uint8_t>((uuid.bytes[6] & 0x0FU) | 0x40U);  // version 4
  uuid.bytes[8] = static_cast<std::uint8_t>((uuid.bytes[8] & 0x3FU) | 0x80U);  // variant
  return uuid;
}

std::optional<Uuid> Uuid::parse(std::string_view text) {
  if (text.size() != kTextLength)
    return std::nullopt;
  std::string digits(text);
  for (auto dash = kDashes.rbegin(); dash != kDashes.rend(); ++dash) {
    if (digits[*dash] != '-')
      return std::nullopt;
    digits.erase(*dash, 1);
  }
  Uuid uuid;
  if (!parse_hex(digits, uuid.bytes))
    return std::nullopt;
  return uuid;
}

}  // namespace kinship
