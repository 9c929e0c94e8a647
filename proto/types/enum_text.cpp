#include "proto/types/enum_text.hpp"

#include <string>

namespace kinship {

Error not_one_of(std::string_view what, std::string_view text,
                 std::span<const std::string_view> words) {
  constexpr std::size_t kMaxShown = 40;
  std::string message =
      std::string(what) + ": '" + std::string(text.substr(0, kMaxShown)) + "' is not one of ";
  for (const std::string_view word : words)
    message += (word == words.front() ? "" : ", ") + std::string(word);
  return {ErrorCode::InvalidInput, message};
}

}  // namespace kinship
