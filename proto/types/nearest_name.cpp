#include "proto/types/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace kinship {
namespace {

constexpr std::string_view kBefore = " (did you mean '";

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

std::size_t max_edits(std::string_view word) noexcept {
  constexpr std::size_t kShort = 4;  // letters of a word, most of which are other words' too
  return word.size() <= kShort ? 1 : 2;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates) {
  std::size_t least = max_edits(word) + 1;
  const std::string* nearest = nullptr;
  for (const std::string& candidate : candidates) {
    const auto [shorter, longer] = std::minmax({word.size(), candidate.size()});
    if (longer - shorter >= least || candidate == word)  // it itself is right, but elsewhere
      continue;
    if (const std::size_t distance = edit_distance(word, candidate); distance < least) {
      least = distance;
      nearest = &candidate;
    }
  }
  return nearest == nullptr ? "" : std::string(kBefore) + *nearest + "'?)";
}

std::string without_suggestion(std::string message) {
  if (const std::size_t at = message.rfind(kBefore); at != std::string::npos)
    message.erase(at);
  return message;
}

}  // namespace kinship
