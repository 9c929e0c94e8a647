#pragma once

#include <string>

#include "proto/types/store_check.hpp"

namespace kinship::json {

/// The document of `kinshipd check --json`. Member names are those of the struct and never change.
std::string to_json(const StoreCheck& check);

}  // namespace kinship::json
