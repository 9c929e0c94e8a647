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
  std::optional<double> budget = {};        ///< of the value: at most, or at least; not of a time
  std::optional<double> ratio_budget = {};  ///< of value / reference
  std::string note = {};
};

/// Prints it as a line of JSON on standard output, which tests/bench/run.py collects. Texts are
/// plain: no control characters.
/// \throws std::logic_error if a number is not finite, or a ratio has a budget but no reference.
inline void print(const Figure& figure) {
  if (!std::isfinite(figure.value) || (figure.reference && !std::isfinite(figure.reference->value)))
    throw std::logic_error("figure '" + figure.name + "' is not finite");
  if (figure.ratio_budget && !figure.reference)
    throw std::logic_error("figure '" + figure.name + "' has a budget but no reference");
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
