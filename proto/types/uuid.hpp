#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kinship {

/// A UUID in the byte order of its text (RFC 9562, section 4). Clients make one per report, so that
/// a retry is recognised; a store has one per epoch.
struct Uuid {
  std::array<std::uint8_t, 16> bytes{};

  auto operator<=>(const Uuid&) const = default;

  std::string text() const;  ///< 8-4-4-4-12, lower case

  /// Version 4, from the operating system's random source.
  static Uuid random();

  /// \return empty unless `text` has the form 8-4-4-4-12 in hexadecimal digits.
  static std::optional<Uuid> parse(std::string_view text);
};

}  // namespace kinship
