#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace kinship {

/// Whether a byte of UTF-8 begins a character.
constexpr bool begins_character(char byte) noexcept {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

/// Number of characters of a text in UTF-8.
inline std::size_t character_count(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

/// The start of a text from outside, for quotation in a message: at most 40 bytes, each that is not
/// printable ASCII replaced by '?'.
inline std::string printable_start(std::string_view text) {
  std::string start(text.substr(0, 40));
  std::ranges::replace_if(
      start, [](char byte) { return byte < ' ' || byte > '~'; }, '?');
  return start;
}

}  // namespace kinship
