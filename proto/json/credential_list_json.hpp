#pragma once

#include <string>

#include "proto/types/credential_list.hpp"

namespace kinship::json {

/// The document of `kinshipd secure list --json`. Member names are those of the struct and never
/// change.
std::string to_json(const CredentialList& list);

}  // namespace kinship::json
