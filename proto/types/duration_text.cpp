#include "proto/types/duration_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace kinship {
namespace {

struct DurationUnit {
  double seconds;
  const char* name;
};

constexpr std::array<DurationUnit, 3> kDurationUnits = {{{1, "s"}, {1e-3, "ms"}, {1e-6, "µs"}}};
constexpr double kRoundsUp = 0.9995;  // to one of the unit, with three digits

/// Behind the point, so that there are three in all.
int digits_of(double value) {
  constexpr double kHundred = 99.95, kTen = 9.995;
  if (value >= kHundred)
    return 0;
  return value >= kTen ? 1 : 2;
}

}  // namespace

std::string duration_text(double seconds) {
  if (seconds == 0)
    return "0 s";
  const DurationUnit* unit = kDurationUnits.data();
  while (unit != &kDurationUnits.back() && std::abs(seconds) < kRoundsUp * unit->seconds)
    ++unit;
  const double value = seconds / unit->seconds;
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.*f %s", digits_of(std::abs(value)), value, unit->name);
  return text.data();
}

}  // namespace kinship
