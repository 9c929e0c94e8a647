#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/result.hpp"

namespace kinship::security {

/// The client of a certificate and its generation. Each renewal of a client has the next
/// generation, which follows a point in the name: "arm_7", "arm_7.2", "arm_7.3". So certificates of
/// one client have subjects, permissions and partitions of their own, and the server can tell them
/// apart.
struct CertificateName {
  std::string client;
  std::uint32_t generation = 1;
};

/// The common name of the certificate.
std::string common_name(const CertificateName& name);

/// \return an error for a name that is not a client's: another form, or the server's.
Result<CertificateName> read_certificate_name(std::string_view common_name);

/// The client whose certificate has this common name; other names are returned unchanged.
std::string client_of(std::string_view common_name);

}  // namespace kinship::security
