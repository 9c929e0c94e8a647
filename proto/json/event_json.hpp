#pragma once

#include <string>

#include "proto/types/publications.hpp"

namespace kinship::json {

std::string to_json(const Event& event);  ///< a line of `watch --json`

}  // namespace kinship::json
