#include "server/app/upstream_url.hpp"

namespace kinship::app {

bool is_upstream_url(std::string_view text) {
  return text.starts_with("postgresql://") || text.starts_with("postgres://");
}

}  // namespace kinship::app
