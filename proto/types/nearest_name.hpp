#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace kinship {

/// Number of insertions, deletions and changes of letters, and swaps of neighbours, that turn one
/// word into the other. Source: Damerau, A Technique for Computer Detection and Correction of
/// Spelling Errors (1964); no letter is edited twice.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// How many edits make a misspelt word: two, or one of a word of four letters or fewer.
std::size_t max_edits(std::string_view word) noexcept;

/// " (did you mean 'register'?)" with the candidate nearest to a misspelt word, the first of
/// several; empty if none is within max_edits() of it.
std::string suggestion(std::string_view word, std::span<const std::string> candidates);

/// A message without the suggestion() at its end, for callers that may not see all names.
std::string without_suggestion(std::string message);

}  // namespace kinship
