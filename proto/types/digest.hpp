#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace kinship {

/// A SHA-256 digest: the identity of a robot, of a distribution, of a path's content.
struct Digest {
  std::array<std::uint8_t, 32> bytes{};

  auto operator<=>(const Digest&) const = default;

  std::string hex() const;                                       ///< 64 lower-case digits
  std::string short_hex() const { return hex().substr(0, 12); }  ///< for people

  /// \return empty unless `text` is 64 hexadecimal digits.
  static std::optional<Digest> from_hex(std::string_view text);
};

}  // namespace kinship

template <>
struct std::hash<kinship::Digest> {
  std::size_t operator()(const kinship::Digest& digest) const noexcept {
    std::size_t value = 0;  // the digest is uniform already: its first bytes are a hash
    for (std::size_t i = 0; i < sizeof value; ++i)
      value = (value << 8U) | digest.bytes[i];
    return value;
  }
};
