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

/// How many characters a text in UTF-8 has.
inline std::size_t character_count(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

/// The start of a text from outside as a message quotes it: at most 40 bytes, with a '?' for each
/// that is no printable character of ASCII.
inline std::string printable_start(std::string_view text) {
  std::string start(text.substr(0, 40));
  std::ranges::replace_if(
      start, [](char byte) { return byte < ' ' || byte > '~'; }, '?');
  return start;
}

}  // namespace kinship
