#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

namespace kinship::arguments {

/// A check of an option's number: within `lowest` and `highest`, both included, and a number at all
/// (CLI::Range lets "nan" pass). Help shows it as "0.01 to 86400".
template <typename Number>
CLI::Validator between(Number lowest, Number highest) {
  constexpr int kDigits = 10;
  std::ostringstream text;
  text.precision(kDigits);
  text << lowest << " to " << highest;
  const std::string range = text.str();
  return CLI::Validator(
      [=](std::string& given) {
        Number value{};
        const bool is_within =
            CLI::detail::lexical_cast(given, value) && lowest <= value && value <= highest;
        return is_within ? std::string() : "'" + given + "' is not a number from " + range;
      },
      range);
}

}  // namespace kinship::arguments
