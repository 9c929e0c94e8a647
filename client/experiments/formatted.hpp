#pragma once

#include <cstdio>
#include <string>

namespace kinship::experiments {

/// What snprintf makes of these, whole, however long.
template <typename... Values>
std::string formatted(const char* format, Values... values) {
  std::string text(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)), '\0');
  std::snprintf(text.data(), text.size() + 1, format, values...);
  return text;
}

}  // namespace kinship::experiments
