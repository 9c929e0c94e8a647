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

/// Common name of the server's certificate, and what no client may be called.
inline constexpr const char* kServerName = "server";

/// How long before credentials end people are told.
inline constexpr std::chrono::days kWarnedBefore{30};

/// Files of a credentials folder: what a participant needs to prove who it is.
struct CredentialFiles {
  explicit CredentialFiles(const std::filesystem::path& folder)
      : authorities(folder / "ca.pem"),
        trusted(folder / "trusted"),
        certificate(folder / "certificate.pem"),
        key(folder / "key.pem"),
        governance(folder / "governance.p7s"),
        permissions(folder / "permissions.p7s"),
        identity(folder / "identity.toml") {}

  std::filesystem::path authorities;  ///< first the one that issued the certificate
  std::filesystem::path trusted;      ///< a folder with the same authorities, one in each file
  std::filesystem::path certificate;
  std::filesystem::path key;
  std::filesystem::path governance;
  std::filesystem::path permissions;
  std::filesystem::path identity;
};

/// What a credentials folder says, without its key.
struct Credentials {
  std::string name;  ///< common name of the certificate: CertificateName, or "server"
  std::string role;  ///< of a client, or "server"
  std::chrono::sys_seconds expires;
  std::size_t authorities = 0;  ///< trusted: one, or two while authorities change
};

/// Reads a credentials folder and checks that its files belong together and are valid now. Cyclone
/// DDS would only say that the participant cannot be made.
/// \return an error that names the file, and what to do about it.
Result<Credentials> read_credentials(const std::filesystem::path& folder,
                                     std::chrono::sys_seconds now);

/// Words for who starts a program: that the credentials are valid for less than 30 days; nothing
/// before that.
std::optional<std::string> expiry_warning(const Credentials& credentials,
                                          std::chrono::sys_seconds now);

/// Whose credentials are to be written.
struct CredentialWish {
  std::string name;
  std::string role;  ///< as it goes into identity.toml
  Validity validity;
  std::string permissions;  ///< text, unsigned
};

/// Who vouches for credentials.
struct Vouchers {
  Authority issuer;                  ///< of the certificate
  Authority signer;                  ///< of the documents
  std::vector<Certificate> trusted;  ///< by whoever has the folder; first the issuer
};

/// Writes a credentials folder, which must be empty or not be there yet, with a new key that nobody
/// else has.
/// \return its certificate.
/// \throws Failure that names the file; what was written is removed then.
Certificate write_credentials(const std::filesystem::path& folder, const CredentialWish& wish,
                              const Vouchers& vouchers);

}  // namespace kinship::security
