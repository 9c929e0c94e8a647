#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace kinship {

/// Letters that are put in, taken out or changed, and neighbours that are swapped, to make one word
/// of another. Source: Damerau, A Technique for Computer Detection and Correction of Spelling
/// Errors (1964); no letter takes part twice.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// " (did you mean 'register'?)" with the candidate that is nearest to a misspelt word, the first
/// of several; empty if none is within two letters of it, or one for a word of four letters or
/// fewer.
std::string suggestion(std::string_view word, std::span<const std::string> candidates);

}  // namespace kinship
