#include "server/app/upstream_url.hpp"

namespace kinship::app {

bool is_upstream_url(std::string_view text) {
  return text.starts_with("postgresql://") || text.starts_with("postgres://");
}

std::string name_of_upstream(std::string_view url) {
  const std::size_t behind_scheme = url.find("://") + 3;
  std::string_view place = url.substr(behind_scheme);
  place = place.substr(0, place.find('?'));
  // A password may hold an @ itself, a host may not.
  if (const std::size_t user = place.rfind('@'); user != std::string_view::npos)
    place.remove_prefix(user + 1);
  return std::string(url.substr(0, behind_scheme)) + std::string(place);
}

}  // namespace kinship::app
