#include "server/store/sqlite/database/page_seal.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

constexpr std::array<std::uint8_t, 4> kSealMark = {'K', 'P', 'C', 1};  // the last: its version

std::uint32_t crc_of_page(std::span<const std::uint8_t> page, std::uint64_t number) noexcept {
  std::array<std::uint8_t, sizeof number> bytes{};
  std::memcpy(bytes.data(), &number, sizeof number);
  return crc32c(page.first(page.size() - kSealBytes), crc32c(bytes));
}

}  // namespace

bool is_page(std::size_t size, std::int64_t offset) noexcept {
  constexpr std::size_t kSmallest = 512, kLargest = 65536;
  return size >= kSmallest && size <= kLargest && std::has_single_bit(size) && offset >= 0 &&
         static_cast<std::uint64_t>(offset) % size == 0;
}

void seal_page(std::span<std::uint8_t> page, std::uint64_t number) noexcept {
  const std::uint32_t crc = crc_of_page(page, number);
  const std::span<std::uint8_t> seal = page.last(kSealBytes);
  std::ranges::copy(kSealMark, seal.begin());
  std::memcpy(seal.data() + kSealMark.size(), &crc, sizeof crc);
}

void spoil_seal(std::span<std::uint8_t> page) noexcept {
  for (std::uint8_t& byte : page.last(kSealBytes - kSealMark.size()))
    byte = static_cast<std::uint8_t>(~byte);
}

bool is_sealed(std::span<const std::uint8_t> page, std::uint64_t number) noexcept {
  if (!bears_seal(page))
    return false;
  std::uint32_t crc = 0;
  std::memcpy(&crc, page.data() + page.size() - sizeof crc, sizeof crc);
  return crc == crc_of_page(page, number);
}

bool bears_seal(std::span<const std::uint8_t> page) noexcept {
  return std::ranges::equal(page.last(kSealBytes).first(kSealMark.size()), kSealMark);
}

bool is_hole(std::span<const std::uint8_t> page) noexcept {
  return std::ranges::all_of(page, [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace kinship::store
