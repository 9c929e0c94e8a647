#pragma once

#include <string>
#include <string_view>

namespace kinship::app {

/// Whether a text names a memory above a site: postgresql://... or postgres://...
bool is_upstream_url(std::string_view text);

/// What may be said to people of it: without user, password and parameters.
std::string name_of_upstream(std::string_view url);

}  // namespace kinship::app
