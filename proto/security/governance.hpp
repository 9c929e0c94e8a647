#pragma once

#include <string>

namespace kinship::security {

/// What protects every domain and topic, as a governance document of DDS Security 1.1, unsigned.
std::string governance_text();

}  // namespace kinship::security
