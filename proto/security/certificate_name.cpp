#include "proto/security/certificate_name.hpp"

#include <charconv>

#include "proto/security/client_record.hpp"

namespace kinship::security {

std::string common_name(const CertificateName& name) {
  return name.generation == 1 ? name.client : name.client + "." + std::to_string(name.generation);
}

Result<CertificateName> read_certificate_name(std::string_view common_name) {
  const std::size_t point = common_name.find('.');
  CertificateName name{.client = std::string(common_name.substr(0, point))};
  if (const auto error = check_client_name(name.client))
    return *error;
  if (point == std::string_view::npos)
    return name;
  const std::string_view digits = common_name.substr(point + 1);
  const char* const end = digits.data() + digits.size();
  const auto [stopped, error] = std::from_chars(digits.data(), end, name.generation);
  // One form for each generation: "arm.02" or "arm.1" would be other partitions of the same client.
  if (error != std::errc() || stopped != end || name.generation < 2 || digits.front() == '0')
    return invalid_input("name '" + name.client + "': behind the point is no generation");
  return name;
}

std::string client_of(std::string_view common_name) {
  const Result<CertificateName> name = read_certificate_name(common_name);
  return name ? name->client : std::string(common_name);
}

}  // namespace kinship::security
