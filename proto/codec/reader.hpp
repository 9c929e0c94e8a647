#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "proto/types/digest.hpp"
#include "proto/types/rules.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::codec {

/// The elements of a sequence of Cyclone DDS; empty for one that a shorter message left out.
template <typename Sequence>
auto elements(const Sequence& sequence) {
  using Element = std::remove_pointer_t<decltype(sequence._buffer)>;
  return std::span<const Element>(sequence._buffer, sequence._buffer ? sequence._length : 0);
}

Digest read_digest(const std::uint8_t (&bytes)[32]);
Uuid read_uuid(const std::uint8_t (&bytes)[16]);
/// A text of any length, which the check of its value limits.
/// \param text  may be null (a shorter message left it out): reads as empty.
inline std::string read_text(const char* text) { return text ? text : ""; }
/// Its length, without a copy.
inline std::size_t text_bytes(const char* text) { return text == nullptr ? 0 : std::strlen(text); }

/// Converts members of an incoming message to parts of a value and records the first broken rule.
/// Sizes are checked before memory is allocated; values returned after a broken rule are
/// meaningless.
class Reader {
 public:
  /// None or seven numbers.
  std::optional<Eigen::Isometry3d> placement(std::string_view what, std::span<const double> pose);
  Eigen::Isometry3d pose(std::string_view what, std::span<const double, 7> pose);

  /// None or 32 bytes.
  std::optional<Digest> optional_digest(std::string_view what, std::span<const std::uint8_t> bytes);

  /// None or one finite number.
  std::optional<double> optional_number(std::string_view what, std::span<const double> value);

  /// \param last  the enumerator with the largest value; they count from 0.
  template <typename Enumeration>
  Enumeration enumerator(std::string_view what, std::uint32_t value, Enumeration last) {
    rules.between(what, value, 0, static_cast<double>(last));
    return static_cast<Enumeration>(std::min(value, static_cast<std::uint32_t>(last)));
  }

  Rules rules;
};

}  // namespace kinship::codec
