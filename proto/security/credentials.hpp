#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/security/certificate.hpp"
#include "proto/security/signed_document.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// Common name of the server's certificate; no client may have it.
inline constexpr const char* kServerName = "server";

/// Time before the expiry of credentials from which programs warn.
inline constexpr std::chrono::days kWarnedBefore{30};

/// Files of a credentials folder, with which a participant proves its identity.
struct CredentialFiles {
  explicit CredentialFiles(const std::filesystem::path& folder)
      : authorities(folder / "ca.pem"),
        trusted(folder / "trusted"),
        certificate(folder / "certificate.pem"),
        key(folder / "key.pem"),
        governance(folder / "governance.p7s"),
        permissions(folder / "permissions.p7s"),
        identity(folder / "identity.toml") {}

  std::filesystem::path authorities;  ///< the issuer of the certificate first
  std::filesystem::path trusted;      ///< a folder with the same authorities, one in each file
  std::filesystem::path certificate;
  std::filesystem::path key;
  std::filesystem::path governance;
  std::filesystem::path permissions;
  std::filesystem::path identity;
};

/// Content of a credentials folder, without its key.
struct Credentials {
  std::string name;  ///< common name of the certificate: CertificateName, or "server"
  std::string role;  ///< of a client, or "server"
  std::chrono::sys_seconds expires;
  std::size_t authorities = 0;  ///< trusted: one, or two while authorities change
};

/// Reads a credentials folder and checks that its files belong together and are valid now. Cyclone
/// DDS would only report that the participant cannot be made.
/// \return an error that names the file and a remedy.
Result<Credentials> read_credentials(const std::filesystem::path& folder,
                                     std::chrono::sys_seconds now);

/// A warning at the start of a program that the credentials are valid for less than 30 days;
/// nothing before that.
std::optional<std::string> expiry_warning(const Credentials& credentials,
                                          std::chrono::sys_seconds now);

/// Content of credentials to write.
struct CredentialWish {
  std::string name;
  std::string role;  ///< as written to identity.toml
  Validity validity;
  std::string permissions;  ///< text, unsigned
};

/// The authorities behind credentials.
struct Vouchers {
  Authority issuer;                  ///< of the certificate
  Authority signer;                  ///< of the documents
  std::vector<Certificate> trusted;  ///< by the owner of the folder; the issuer first
};

/// Writes a credentials folder, which must be empty or not be there yet, with a new private key.
/// \return its certificate.
/// \throws Failure that names the file; then the written files are removed.
Certificate write_credentials(const std::filesystem::path& folder, const CredentialWish& wish,
                              const Vouchers& vouchers);

}  // namespace kinship::security
