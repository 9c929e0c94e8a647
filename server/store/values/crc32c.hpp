#pragma once

#include <cstdint>
#include <span>

namespace kinship::store {

/// CRC-32C (Castagnoli polynomial, reflected, as in RFC 3720 section 12.1) of `bytes`. Finds every
/// burst of up to 32 flipped bits. Uses the processor's instruction where it has one.
/// \param previous  the CRC of the bytes before `bytes`; 0 at the beginning.
std::uint32_t crc32c(std::span<const std::uint8_t> bytes, std::uint32_t previous = 0);

/// The same without that instruction.
std::uint32_t crc32c_by_tables(std::span<const std::uint8_t> bytes, std::uint32_t previous = 0);

}  // namespace kinship::store
