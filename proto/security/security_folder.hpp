#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/security/authority_folder.hpp"
#include "proto/security/client_record.hpp"
#include "proto/security/credentials.hpp"
#include "proto/types/credential_list.hpp"

namespace kinship::security {

inline constexpr std::chrono::days kDefaultDays{365};
inline constexpr std::chrono::days kMaxDays{3653};  ///< 10 years, as for an authority

/// A client to add.
struct NewClient {
  std::string name;
  AccessRole role = AccessRole::Robot;
  std::vector<std::string> tasks = {};
  std::vector<std::string> robots = {};
  std::chrono::days days = kDefaultDays;
};

/// Files of a certificate for browsers.
struct HostCertificate {
  std::filesystem::path certificate, key;
};

/// The folder of a fleet's security: authority, the server's credentials, records of clients.
///
/// Each function throws Failure that names the thing, its value and a remedy. Several processes may
/// change it at once: one waits for the other.
class SecurityFolder {
 public:
  /// Makes the folder with an authority (10 years) and the server's credentials.
  /// \throws Failure(Conflict) if `folder` is not empty.
  static SecurityFolder init(const std::filesystem::path& folder, std::chrono::days server_days,
                             std::chrono::sys_seconds now);

  /// Opens a folder made by init().
  /// \param authority_key  file of the authority's key; empty: authority/ca.key in the folder.
  /// \throws Failure(NotFound) if it is not one, Failure(Conflict) if it belongs to another user.
  explicit SecurityFolder(std::filesystem::path folder,
                          const std::filesystem::path& authority_key = {});

  /// Writes the client's credentials into `out` and its record.
  /// \throws Failure(Conflict) if the name is taken or `out` is not empty, Failure(InvalidInput)
  ///         for an invalid name, pattern or label.
  ClientRecord add(const NewClient& client, const std::filesystem::path& out,
                   std::chrono::sys_seconds now) const;

  /// Writes new credentials, with a new key, for an existing client; its former ones stay valid
  /// until revoke_former().
  /// \throws Failure(Conflict) if it is revoked.
  ClientRecord renew(const std::string& name, std::chrono::days days,
                     const std::filesystem::path& out, std::chrono::sys_seconds now) const;

  /// Revokes a client: the server refuses it from now on. Its name stays taken.
  /// \throws Failure(NotFound) if there is no such client.
  ClientRecord revoke(const std::string& name, std::chrono::sys_seconds now) const;

  /// Revokes a client's credentials except the newest.
  /// \throws Failure(NotFound) if there is no such client, Failure(Conflict) if it was never
  /// renewed.
  ClientRecord revoke_former(const std::string& name) const;

  /// Writes a revocation into a record that lacks it, because it was put back from a copy.
  /// \throws Failure(NotFound) if there is no such client.
  void revoke_again(const Revocation& revocation) const;

  /// Fingerprints of the trusted authorities.
  std::vector<std::string> authorities() const;

  /// The server and all clients, including clients with an unreadable record.
  CredentialList list(std::chrono::sys_seconds now) const;

  /// Writes new credentials for the server, which it reads when it starts.
  /// \return the folder of its former credentials.
  std::filesystem::path renew_server(std::chrono::days days, std::chrono::sys_seconds now) const;

  /// Adds a second authority: it issues clients' credentials from now on, and the server trusts
  /// both after a restart.
  /// \return the folder of the server's former credentials.
  std::filesystem::path renew_authority(std::chrono::days server_days,
                                        std::chrono::sys_seconds now);

  /// Replaces all authorities by a new one, if a key was leaked or lost. Clients cannot connect
  /// until they have new credentials.
  /// \return the folder of the server's former credentials.
  std::filesystem::path replace_authority(std::chrono::days server_days,
                                          std::chrono::sys_seconds now);

  /// Names of clients, neither revoked nor expired, whose credentials the previous authority
  /// issued.
  std::vector<std::string> clients_of_previous_authority(std::chrono::sys_seconds now) const;
  /// The same for clients whose credentials trust a retired authority.
  std::vector<std::string> clients_that_trust_retired(std::chrono::sys_seconds now) const;

  /// Retires the previous of two authorities: the server gets credentials of the newer one and,
  /// after a restart, trusts only that and refuses signatures of the previous one. Clients that
  /// were renewed before still accept a server certified by the previous one, until they are
  /// renewed once more (trusts_a_retired_authority in the list).
  /// \return the file of the previous authority's key; empty if it is kept elsewhere.
  std::filesystem::path retire_authority(std::chrono::days server_days,
                                         std::chrono::sys_seconds now);

  /// The certificate that names these hosts, DIR/console, of the authority that issues the
  /// server's: the one that is there, or a new one for a year if that lacks a host, is not of a
  /// trusted authority, or is valid for less than 30 days.
  /// \throws Failure if one is needed and cannot be made, e.g. because the authority's key is kept
  ///         elsewhere.
  HostCertificate host_certificate(const std::vector<std::string>& hosts,
                                   std::chrono::sys_seconds now) const;

  std::filesystem::path server_credentials() const { return folder_ / "server"; }
  std::filesystem::path clients() const { return folder_ / "clients"; }

 private:
  std::filesystem::path replace_server(std::chrono::days days, std::chrono::sys_seconds now) const;
  std::filesystem::path record_file(const std::string& name) const;
  ClientRecord record_of(const std::string& name) const;
  ClientRecord issue_to(ClientRecord record, std::chrono::days days,
                        const std::filesystem::path& out, std::chrono::sys_seconds now) const;

  std::filesystem::path folder_;
  AuthorityFolder authority_;
};

}  // namespace kinship::security
