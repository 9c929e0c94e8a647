#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Files that say, byte by byte, what the program writes.
namespace kinship::test {

/// Expects that tests/golden/pins/NAME holds `text`. With KINSHIP_WRITE_GOLDEN in the environment
/// the file is written instead.
void expect_pinned(const std::string& name, std::string_view text);

/// The same of bytes, which the file has as hexadecimal digits, 32 bytes a line.
void expect_pinned_bytes(const std::string& name, std::span<const std::uint8_t> bytes);

std::string read_pin(const std::string& name);
std::vector<std::uint8_t> read_pinned_bytes(const std::string& name);

}  // namespace kinship::test
