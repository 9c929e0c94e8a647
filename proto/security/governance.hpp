#pragma once

#include <string>

namespace kinship::security {

/// The protection of every domain and topic, as a governance document of DDS Security 1.1,
/// unsigned.
std::string governance_text();

}  // namespace kinship::security
