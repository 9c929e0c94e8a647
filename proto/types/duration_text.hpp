#pragma once

#include <string>

namespace kinship {

/// A time for people, three digits in the unit that fits it: "2.50 s", "412 ms", "85.1 µs".
std::string duration_text(double seconds);

}  // namespace kinship
