#pragma once

#include <chrono>
#include <string>

namespace kinship::security {

/// "2026-11-25T19:48:20Z": as TOML, JSON and DDS Security write it.
std::string time_text(std::chrono::sys_seconds time);

}  // namespace kinship::security
