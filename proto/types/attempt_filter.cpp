#include "proto/types/attempt_filter.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "proto/types/enum_text.hpp"

namespace kinship {

template <>
struct Words<OutcomeFilter> {
  static constexpr std::string_view kWhat = "outcome";
  static constexpr std::array<std::string_view, 5> kWords = {"all", "solved", "unsolved", "timeout",
                                                             "failed"};
};
template <>
struct Words<AttemptOrder> {
  static constexpr std::string_view kWhat = "order";
  static constexpr std::array<std::string_view, 2> kWords = {"newest", "slowest"};
};

namespace {

constexpr std::array<std::string_view, 3> kKeys = {"outcome", "since_ms", "order"};

template <typename Enum>
std::optional<Error> set(Enum& value, std::string_view text) {
  const Result<Enum> word = parse_word<Enum>(text);
  if (!word)
    return word.error();
  value = *word;
  return std::nullopt;
}

std::optional<Error> set(std::int64_t& value, std::string_view text) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && value >= 0)
    return std::nullopt;
  return Error{ErrorCode::InvalidInput, "since_ms: '" + std::string(text) + "' is no time"};
}

std::optional<Error> set(AttemptFilter& filter, std::string_view key, std::string_view value) {
  if (key == kKeys[0])
    return set(filter.outcome, value);
  if (key == kKeys[1])
    return set(filter.since_ms, value);
  if (key == kKeys[2])
    return set(filter.order, value);
  return not_one_of("filter of attempts", key, kKeys);
}

}  // namespace

std::string to_text(const AttemptFilter& filter) {
  std::string text;
  const auto add = [&text](std::string_view key, std::string_view value) {
    text.append(text.empty() ? "" : ",").append(key).append("=").append(value);
  };
  if (filter.outcome != OutcomeFilter::All)
    add(kKeys[0], to_text(filter.outcome));
  if (filter.since_ms != 0)
    add(kKeys[1], std::to_string(filter.since_ms));
  if (filter.order != AttemptOrder::Newest)
    add(kKeys[2], to_text(filter.order));
  return text;
}

Result<AttemptFilter> attempt_filter_from_text(std::string_view text) {
  AttemptFilter filter;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    const std::size_t equals = std::min(part.find('='), part.size());
    if (const auto error =
            set(filter, part.substr(0, equals), part.substr(std::min(equals + 1, part.size()))))
      return *error;
    text = comma == std::string_view::npos ? std::string_view() : text.substr(comma + 1);
  }
  return filter;
}

}  // namespace kinship
