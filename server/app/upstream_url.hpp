#pragma once

#include <string_view>

namespace kinship::app {

/// Whether a text names a memory above a site: postgresql://... or postgres://...
bool is_upstream_url(std::string_view text);

}  // namespace kinship::app
