#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// The checksum at the end of each page of a store's file.
namespace kinship::store {

/// Bytes at the end of a page that SQLite leaves unused (byte 20 of the file's header): a magic of
/// four bytes, and the CRC-32C of all bytes before it and of the page's number, which also finds a
/// page written to the place of another.
inline constexpr std::size_t kSealBytes = 8;

/// Whether `size` bytes at `offset` of a database file are one whole page.
bool is_page(std::size_t size, std::int64_t offset) noexcept;

/// \param page    a whole page; its last kSealBytes are overwritten.
/// \param number  counted from 1, as SQLite does.
void seal_page(std::span<std::uint8_t> page, std::uint64_t number) noexcept;

/// Makes the checksum wrong, for a page whose content is known to be wrong.
void spoil_seal(std::span<std::uint8_t> page) noexcept;

/// Whether the checksum fits the page and its number.
bool is_sealed(std::span<const std::uint8_t> page, std::uint64_t number) noexcept;

/// Whether the page has a checksum, right or wrong.
bool bears_seal(std::span<const std::uint8_t> page) noexcept;

/// Whether the page was never written: a hole in the file.
bool is_hole(std::span<const std::uint8_t> page) noexcept;

}  // namespace kinship::store
