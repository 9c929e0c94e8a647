#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Bytes as text (RFC 4648, section 4), for rows of the admin conversation.
namespace kinship {

std::string to_base64(std::span<const std::uint8_t> bytes);

/// \return nothing if the text is not Base64, or lacks its padding.
std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text);

}  // namespace kinship
