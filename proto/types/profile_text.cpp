#include "proto/types/profile_text.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"

namespace kinship {
namespace {

/// Calls visit(field, parameters) for each parameter of a profile that a client may change.
template <typename Visit>
void for_each_option(Profile& profile, Visit visit) {
  const auto visit_limited = [&](const auto& field, auto& parameters) {
    if (field.rules.max < std::numeric_limits<double>::max())
      visit(field, parameters);
  };
  for_each_field<TransferParameters>(
      [&](const auto& field) { visit_limited(field, profile.transfer); });
  for_each_field<DensityParameters>(
      [&](const auto& field) { visit_limited(field, profile.density); });
}

Error refusal(std::string_view text, const std::string& why) {
  // Half of it for the text: it may be anything.
  return {
      ErrorCode::InvalidInput,
      cut_text("profile '" + cut_text(text, kMaxMessageBytes / 2) + "': " + why, kMaxMessageBytes)};
}

/// The value of an option, or nothing if the text is none within its limits. `auto` components are
/// 0 and an `auto` prior is kChosenPrior, which stand for "choose it".
template <typename Of, typename T>
std::optional<T> value_of(const Field<Of, T>& option, std::string_view text) {
  if constexpr (std::is_enum_v<T>) {
    const Result<T> word = parse_word<T>(text);
    return word ? std::optional(*word) : std::nullopt;
  } else {
    if constexpr (std::is_same_v<T, bool>)
      if (text == "yes" || text == "no")
        return text == "yes";
    if (text == "auto" && option.name == "components")
      return T{0};
    if constexpr (std::is_same_v<T, double>)
      if (text == "auto" && option.name == "prior")
        return kChosenPrior;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() ||
        !(value >= option.rules.min && value <= option.rules.max) ||
        (std::is_integral_v<T> && value != std::round(value)))
      return std::nullopt;
    return static_cast<T>(value);
  }
}

/// "is not a whole number from 0 to 100", "is not gmm or kde".
template <typename Of, typename T>
std::string fault_of(const Field<Of, T>& option) {
  if constexpr (std::is_enum_v<T>) {
    std::string words;
    for (const std::string_view word : Words<T>::kWords)
      words += (words.empty() ? "" : " or ") + std::string(word);
    return "is not " + words;
  } else if constexpr (std::is_same_v<T, bool>) {
    return "is not yes or no, nor 1 or 0";
  } else {
    return std::string("is not a") + (std::is_integral_v<T> ? " whole" : "") + " number from " +
           number_text(option.rules.min) + " to " + number_text(option.rules.max);
  }
}

/// Makes the change "name=value".
/// \return its fault.
std::optional<std::string> change(Profile& profile, std::string_view word) {
  const std::size_t sign = word.find('=');
  const std::string_view name = word.substr(0, sign);
  std::optional<std::string> fault = "there is no option '" + std::string(name) + "'";
  for_each_option(profile, [&]<typename Of, typename T>(const Field<Of, T>& option,
                                                        Of& parameters) {
    if (option.name != name)
      return;
    const std::optional<T> value =
        sign == std::string_view::npos ? std::nullopt : value_of(option, word.substr(sign + 1));
    if (value)
      parameters.*option.member = *value;
    fault = value ? std::nullopt : std::optional("'" + std::string(word) + "' " + fault_of(option));
  });
  return fault;
}

}  // namespace

Result<Profile> profile_from_text(std::string_view text) {
  std::size_t comma = text.find(',');
  std::optional<Profile> profile = find_profile(text.substr(0, comma));
  if (!profile)
    return refusal(text, "it does not begin with default or paper");
  while (comma != std::string_view::npos) {
    const std::size_t begin = comma + 1;
    comma = text.find(',', begin);
    if (const auto fault = change(*profile, text.substr(begin, comma - begin)))
      return refusal(text, *fault);
  }
  profile->name = text;
  return *std::move(profile);
}

std::vector<std::string> profile_options() {
  std::vector<std::string> names;
  Profile profile;
  for_each_option(profile,
                  [&names](const auto& option, const auto&) { names.emplace_back(option.name); });
  return names;
}

}  // namespace kinship
