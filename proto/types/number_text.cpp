#include "proto/types/number_text.hpp"

#include <array>
#include <charconv>

namespace kinship {

std::string number_text(double value) {
  std::array<char, 32> text{};  // the longest, "-2.2250738585072014e-308", has 24 characters
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace kinship
