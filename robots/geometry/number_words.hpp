#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace kinship::geometry {

/// Cuts the first line off.
std::string_view take_line(std::string_view& text);

/// Cuts the first word off, which ends at a blank or tab; empty if there is none.
std::string_view take_word(std::string_view& line);

/// The number of a whole word, in any locale; a plus may precede it.
template <typename Number>
std::optional<Number> number_of(std::string_view word) {
  if (word.starts_with('+'))
    word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size())
    return std::nullopt;
  return number;
}

/// \throws Failure(InvalidInput) that quotes a word which is no number, with its line.
[[noreturn]] void refuse_word(std::size_t line_number, std::string_view word);

/// Refuses words that readers of OBJ files would misread: a word in the vertices that is no number
/// as a whole (1,000.5 becomes 1, 0x10 becomes 0).
/// \throws Failure(InvalidInput) as refuse_word, for the first.
void require_obj_numbers(std::string_view text);

/// The same in a DAE file: a comma within coordinates, a transform or the unit (0.5,0,1 becomes 0.5
/// 0.1).
void require_dae_numbers(std::string_view text);

}  // namespace kinship::geometry
