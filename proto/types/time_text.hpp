#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace kinship {

/// ISO 8601 in UTC to the second, "2026-11-25T19:48:20Z": as TOML, JSON and DDS Security write it.
std::string time_text(std::chrono::sys_seconds time);

/// The same for a Unix time in ms.
std::string time_text(std::int64_t unix_ms);

}  // namespace kinship
