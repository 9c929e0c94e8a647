#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/security/client_record.hpp"
#include "proto/security/credentials.hpp"

namespace kinship::security {

inline constexpr std::chrono::days kDefaultDays{365};

/// A client that is to be admitted.
struct NewClient {
  std::string name;
  AccessRole role = AccessRole::Robot;
  std::vector<std::string> tasks = {};
  std::vector<std::string> robots = {};
  std::chrono::days days = kDefaultDays;
};

/// What `secure list` tells of everybody whom the authorities vouch for.
struct ListedCredentials {
  ClientRecord record;
  bool is_server = false;         ///< then only name and expiry of the record count
  bool by_old_authority = false;  ///< needs new ones before that authority is retired
};

/// The folder of a fleet's security: authority, the server's credentials, records of clients.
///
/// Each function throws Failure that names the thing, its value and what to do.
class SecurityFolder {
 public:
  /// Makes the folder with an authority (10 years) and the server's credentials.
  /// \throws Failure(Conflict) if there is anything in `folder`.
  static SecurityFolder init(const std::filesystem::path& folder, std::chrono::days server_days,
                             std::chrono::sys_seconds now);

  /// Opens one that init() made.
  /// \param authority_key  file of the authority's key; empty: authority/ca.key in the folder.
  /// \throws Failure(NotFound) if it is none.
  explicit SecurityFolder(std::filesystem::path folder, std::filesystem::path authority_key = {});

  /// Writes the client's credentials into `out` and its record.
  /// \throws Failure(Conflict) if the name is taken or `out` has anything in it;
  ///         Failure(InvalidInput) for a name, pattern or label that cannot be.
  ClientRecord add(const NewClient& client, const std::filesystem::path& out,
                   std::chrono::sys_seconds now) const;

  /// From now on the server refuses the client. Its name stays taken.
  /// \throws Failure(NotFound) if there is no such client.
  ClientRecord revoke(const std::string& name, std::chrono::sys_seconds now) const;

  std::filesystem::path server_credentials() const { return folder_ / "server"; }
  std::filesystem::path clients() const { return folder_ / "clients"; }

 private:
  std::vector<Certificate> trusted() const;
  Authority authority() const;
  std::filesystem::path record_file(const std::string& name) const;

  std::filesystem::path folder_;
  std::filesystem::path authority_key_;
};

}  // namespace kinship::security
