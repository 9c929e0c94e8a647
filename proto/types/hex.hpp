#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kinship {

/// Two lower-case hexadecimal digits per byte.
std::string to_hex(std::span<const std::uint8_t> bytes);

/// Fills `bytes` from exactly twice as many hexadecimal digits of either case.
/// \return false, with `bytes` unspecified, for any other `text`.
bool parse_hex(std::string_view text, std::span<std::uint8_t> bytes);

}  // namespace kinship
