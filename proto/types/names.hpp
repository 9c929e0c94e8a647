#pragma once

#include <optional>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship {

/// Each returns what is wrong with a name from outside, or nothing if it is fine.
/// Tasks and labels: 1 to 128 or 64 bytes of [A-Za-z0-9_.:-]. Machine and planner: printable
/// UTF-8 without control characters, up to 128 bytes, may be empty.
std::optional<Error> check_task(std::string_view task);
std::optional<Error> check_label(std::string_view label);
std::optional<Error> check_machine(std::string_view machine);
std::optional<Error> check_planner(std::string_view planner);

}  // namespace kinship
