#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/store/sqlite/database/page_seal.hpp"

/// The pages of an SQLite file: https://sqlite.org/fileformat2.html, sections 1.5 (free list), 1.6
/// (b-tree pages), 1.7 (overflow) and 2.1 (records).
namespace kinship::store {

using PageBytes = std::span<const std::uint8_t>;

/// The first byte of a page of a b-tree.
inline constexpr std::uint8_t kIndexInterior = 2, kTableInterior = 5, kIndexLeaf = 10,
                              kTableLeaf = 13;

inline std::uint64_t big_endian(PageBytes bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = at; i < at + size && i < bytes.size(); ++i)
    value = value << 8U | bytes[i];
  return value;
}

/// A number of 1 to 9 bytes.
/// \param at  is moved behind it.
inline std::uint64_t varint(PageBytes bytes, std::size_t& at) {
  constexpr int kMaxBytes = 9;
  std::uint64_t value = 0;
  for (int i = 0; i < kMaxBytes && at < bytes.size(); ++i) {
    const std::uint8_t byte = bytes[at++];
    if (i == kMaxBytes - 1)
      return value << 8U | byte;
    value = value << 7U | (byte & 0x7FU);
    if ((byte & 0x80U) == 0)
      break;
  }
  return value;
}

/// Bytes of a payload in its cell; the rest is on overflow pages.
inline std::uint64_t local_bytes(std::size_t page_size, std::uint64_t payload, bool table) {
  const std::uint64_t usable = page_size - kSealBytes;
  const std::uint64_t most = table ? usable - 35 : (usable - 12) * 64 / 255 - 23;
  const std::uint64_t least = (usable - 12) * 32 / 255 - 23;
  if (payload <= most)
    return payload;
  const std::uint64_t fitting = least + (payload - least) % (usable - 4);
  return fitting <= most ? fitting : least;
}

/// The first overflow page of a payload; 0: it fits into its cell.
/// \param at  of the payload's first byte.
inline std::uint64_t overflow_of(PageBytes page, std::size_t at, std::uint64_t payload,
                                 bool table) {
  const std::uint64_t local = local_bytes(page.size(), payload, table);
  return local == payload ? 0 : big_endian(page, at + static_cast<std::size_t>(local), 4);
}

}  // namespace kinship::store
