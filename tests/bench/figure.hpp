#pragma once

#include <cmath>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

namespace kinship::bench {

enum class Better { Lower, Higher };

/// What the same run measured of something else, in the unit of the figure.
struct Reference {
  std::string name;
  double value = 0;
};

/// One number that backs a claim.
struct Figure {
  std::string name;  ///< unique within the benchmark, equal in every run
  double value = 0;
  std::string unit;
  Better better = Better::Lower;
  std::optional<Reference> reference = {};
  std::optional<double> budget = {};        ///< of the value: at most, or at least; not of time
  std::optional<double> ratio_budget = {};  ///< of value / reference
  std::string note = {};
};

/// Whether a unit is one of time, or so many a second.
inline bool is_of_time(const std::string& unit) {
  const std::string first = unit.substr(0, unit.find(' '));
  return first == "s" || first == "ms" || first == "us" || first == "ns" || first.ends_with("/s");
}

/// Prints it as a line of JSON on standard output, which tests/bench/run.py collects. Texts are
/// plain: no control characters.
/// \throws std::logic_error if a number is not finite, a ratio has a budget but no reference, or a
///         time or rate has a budget of its own: a faster machine would keep it.
inline void print(const Figure& figure) {
  if (!std::isfinite(figure.value) || (figure.reference && !std::isfinite(figure.reference->value)))
    throw std::logic_error("figure '" + figure.name + "' is not finite");
  if (figure.ratio_budget && !figure.reference)
    throw std::logic_error("figure '" + figure.name + "' has a budget but no reference");
  if (figure.budget && is_of_time(figure.unit))
    throw std::logic_error("figure '" + figure.name + "' has a budget that names a machine");
  std::ostringstream line;
  line << std::setprecision(9) << "{\"name\": " << std::quoted(figure.name)
       << ", \"value\": " << figure.value << ", \"unit\": " << std::quoted(figure.unit)
       << ", \"better\": \"" << (figure.better == Better::Lower ? "lower" : "higher") << '"';
  if (figure.reference)
    line << ", \"reference\": {\"name\": " << std::quoted(figure.reference->name)
         << ", \"value\": " << figure.reference->value << '}';
  if (figure.budget)
    line << ", \"budget\": " << *figure.budget;
  if (figure.ratio_budget)
    line << ", \"ratio_budget\": " << *figure.ratio_budget;
  line << ", \"note\": " << std::quoted(figure.note) << '}';
  std::cout << line.str() << std::endl;
}

}  // namespace kinship::bench
