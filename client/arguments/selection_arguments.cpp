#include "client/arguments/selection_arguments.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::arguments {
namespace {

using std::chrono::milliseconds;

Error not_a_time(std::string_view text) {
  return {
      ErrorCode::InvalidInput,
      "'" + cut_text(text, kMaxLabelBytes) +
          "' is no time: give a date (2026-11-21), a time in UTC (2026-11-21T05:32:14Z), an age "
          "(90m, 12h, 14d, 2w) or Unix time in ms, as --json prints it (1795239134000)"};
}

/// Reads digits only, all of the text. \return empty if it is something else or too large.
std::optional<std::int64_t> digits_of(std::string_view text) {
  std::int64_t number = 0;
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

/// "14d" as a duration. \return empty if it is none, or longer than a century.
std::optional<milliseconds> age_of(std::string_view text) {
  struct Unit {
    char letter;
    std::chrono::seconds length;
  };
  using namespace std::chrono_literals;
  static constexpr std::array kUnits = {Unit{'s', 1s}, Unit{'m', 60s}, Unit{'h', 3600s},
                                        Unit{'d', 24h}, Unit{'w', 168h}};
  constexpr std::chrono::seconds kLongest = 24h * 36525;
  if (text.empty())
    return std::nullopt;
  const auto number = digits_of(text.substr(0, text.size() - 1));
  const auto* const unit = std::ranges::find(kUnits, text.back(), &Unit::letter);
  if (!number || unit == kUnits.end() || *number > kLongest / unit->length)
    return std::nullopt;
  return *number * unit->length;
}

/// "1795239134000" as a time since 1970. \return empty if it is no number of at least ten digits
/// (a year, or a count of days without its letter, is not meant so), or beyond the year 9999.
std::optional<milliseconds> unix_ms_of(std::string_view text) {
  constexpr std::size_t kMinDigits = 10;
  constexpr std::int64_t kLatest_ms = 253'402'300'799'999;
  const auto number = digits_of(text);
  if (!number || text.size() < kMinDigits || *number > kLatest_ms)
    return std::nullopt;
  return milliseconds(*number);
}

/// "05:32" or "05:32:14" as a time of the day.
std::optional<milliseconds> time_of_day(std::string_view text) {
  const bool has_seconds = text.size() == 8;
  if (text.size() != 5 && !has_seconds)
    return std::nullopt;
  if (text[2] != ':' || (has_seconds && text[5] != ':'))
    return std::nullopt;
  const auto hours = digits_of(text.substr(0, 2));
  const auto minutes = digits_of(text.substr(3, 2));
  const auto seconds = has_seconds ? digits_of(text.substr(6, 2)) : 0;
  if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || *seconds > 59)
    return std::nullopt;
  return std::chrono::hours(*hours) + std::chrono::minutes(*minutes) +
         std::chrono::seconds(*seconds);
}

/// "2026-11-21", with "T" and a time of the day or without, with "Z" or without.
std::optional<milliseconds> utc_of(std::string_view text) {
  constexpr std::size_t kDate = 10;
  if (text.size() < kDate || text[4] != '-' || text[7] != '-')
    return std::nullopt;
  const auto year = digits_of(text.substr(0, 4));
  const auto month = digits_of(text.substr(5, 2));
  const auto day = digits_of(text.substr(8, 2));
  if (!year || !month || !day)
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(*year)),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok() || *year < 1970)
    return std::nullopt;
  const milliseconds midnight = std::chrono::sys_days(date).time_since_epoch();
  std::string_view rest = text.substr(kDate);
  if (rest.empty())
    return midnight;
  if (rest.back() == 'Z')
    rest.remove_suffix(1);
  if (rest.empty() || rest.front() != 'T')
    return std::nullopt;
  const auto time = time_of_day(rest.substr(1));
  return time ? std::optional(midnight + *time) : std::nullopt;
}

}  // namespace

Result<std::vector<std::string>> parse_robot_names(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string name(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
    if (name.empty() || std::ranges::find(names, name) != names.end())
      continue;
    if (const auto error = check_label(name))  // a digest is made of a label's characters
      return *error;
    names.push_back(name);
  }
  if (names.empty())
    return Error{ErrorCode::InvalidInput, "no robot is named"};
  if (names.size() > kMaxSelectedSources)
    return Error{ErrorCode::TooLarge, std::to_string(names.size()) + " robots, at most " +
                                          std::to_string(kMaxSelectedSources)};
  return names;
}

namespace {

/// Each moment is a distribution of its own: requests soon after each other mean the same one.
milliseconds step_of_age(milliseconds age) {
  constexpr std::chrono::hours kDay{24};
  if (age >= 2 * kDay)
    return kDay;
  return age >= std::chrono::hours(2) ? milliseconds(std::chrono::hours(1))
                                      : milliseconds(std::chrono::minutes(1));
}

}  // namespace

Result<std::int64_t> parse_since(std::string_view text, std::chrono::system_clock::time_point now) {
  if (const auto time = utc_of(text))
    return time->count();
  if (const auto time = unix_ms_of(text))
    return time->count();
  const auto age = age_of(text);
  if (!age)
    return not_a_time(text);
  const auto now_ms = std::chrono::duration_cast<milliseconds>(now.time_since_epoch());
  const milliseconds step = step_of_age(*age);
  return std::max((now_ms - *age) / step * step, milliseconds(0)).count();
}

Result<Selection> read_selection(const SelectionArguments& arguments,
                                 std::chrono::system_clock::time_point now) {
  Selection selection;
  if (!arguments.weighting.empty()) {
    const Result<Weighting> weighting = parse_word<Weighting>(arguments.weighting);
    if (!weighting)
      return weighting.error();
    selection.weighting = *weighting;
  }
  if (!arguments.since.empty()) {
    const Result<std::int64_t> since = parse_since(arguments.since, now);
    if (!since)
      return since.error();
    selection.since_ms = *since;
  }
  return selection;
}

}  // namespace kinship::arguments
