#pragma once

#include <string_view>

namespace kinship::app {

/// Whether a text names a PostgreSQL database: postgresql://... or postgres://...
bool is_database_url(std::string_view text);

}  // namespace kinship::app
