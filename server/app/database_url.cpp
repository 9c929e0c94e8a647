#include "server/app/database_url.hpp"

namespace kinship::app {

bool is_database_url(std::string_view text) {
  return text.starts_with("postgresql://") || text.starts_with("postgres://");
}

}  // namespace kinship::app
