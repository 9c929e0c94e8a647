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
inline constexpr std::chrono::days kMaxDays{3653};  ///< 10 years, those of an authority

/// A client that is to be admitted.
struct NewClient {
  std::string name;
  AccessRole role = AccessRole::Robot;
  std::vector<std::string> tasks = {};
  std::vector<std::string> robots = {};
  std::chrono::days days = kDefaultDays;
};

/// The folder of a fleet's security: authority, the server's credentials, records of clients.
///
/// Each function throws Failure that names the thing, its value and what to do. What changes it may
/// be called by several processes at once: one waits for the other.
class SecurityFolder {
 public:
  /// Makes the folder with an authority (10 years) and the server's credentials.
  /// \throws Failure(Conflict) if there is anything in `folder`.
  static SecurityFolder init(const std::filesystem::path& folder, std::chrono::days server_days,
                             std::chrono::sys_seconds now);

  /// Opens one that init() made.
  /// \param authority_key  file of the authority's key; empty: authority/ca.key in the folder.
  /// \throws Failure(NotFound) if it is none, Failure(Conflict) if it belongs to another user.
  explicit SecurityFolder(std::filesystem::path folder,
                          const std::filesystem::path& authority_key = {});

  /// Writes the client's credentials into `out` and its record.
  /// \throws Failure(Conflict) if the name is taken or `out` has anything in it,
  ///         Failure(InvalidInput) for a name, pattern or label that cannot be.
  ClientRecord add(const NewClient& client, const std::filesystem::path& out,
                   std::chrono::sys_seconds now) const;

  /// New credentials, with a new key, for a client that there is; those it has stay valid until
  /// revoke_former().
  /// \throws Failure(Conflict) if it is revoked.
  ClientRecord renew(const std::string& name, std::chrono::days days,
                     const std::filesystem::path& out, std::chrono::sys_seconds now) const;

  /// From now on the server refuses the client. Its name stays taken.
  /// \throws Failure(NotFound) if there is no such client.
  ClientRecord revoke(const std::string& name, std::chrono::sys_seconds now) const;

  /// From now on the server takes the client's newest credentials only.
  /// \throws Failure(NotFound) if there is no such client, Failure(Conflict) if it was never
  /// renewed.
  ClientRecord revoke_former(const std::string& name) const;

  /// The server and all clients, also those whose record cannot be read.
  CredentialList list(std::chrono::sys_seconds now) const;

  /// New credentials for the server, which it reads when it starts.
  /// \return where those that it had are now.
  std::filesystem::path renew_server(std::chrono::days days, std::chrono::sys_seconds now) const;

  /// A second authority: it issues what clients are given from now on, and the server trusts both
  /// once it was started anew.
  /// \return where the credentials that the server had are now.
  std::filesystem::path renew_authority(std::chrono::days server_days,
                                        std::chrono::sys_seconds now);

  /// For an authority whose key others know, or that is lost: a new one in the place of all that
  /// there are. Clients are shut out, and hear no server, until they have new credentials.
  /// \return where the credentials that the server had are now.
  std::filesystem::path replace_authority(std::chrono::days server_days,
                                          std::chrono::sys_seconds now);

  /// Names of clients, neither revoked nor expired, whose credentials the previous authority
  /// issued.
  std::vector<std::string> clients_of_previous_authority(std::chrono::sys_seconds now) const;
  /// The same of those whose credentials trust an authority that was retired.
  std::vector<std::string> clients_that_trust_retired(std::chrono::sys_seconds now) const;

  /// Ends the time of two authorities: the server is given credentials of the newer one and trusts
  /// that one only, once it was started anew. What the previous one's key signs is refused then.
  /// Clients that were renewed before still take for the server whom the previous one vouches for,
  /// until they are renewed once more (trusts_a_retired_authority in the list).
  /// \return where the previous authority's key is now; empty if it is kept elsewhere.
  std::filesystem::path retire_authority(std::chrono::days server_days,
                                         std::chrono::sys_seconds now);

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
