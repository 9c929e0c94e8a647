#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

#include "proto/security/credentials.hpp"

namespace kinship::security {

/// The authorities of a fleet and their keys: DIR/authority. Mostly one; two while the fleet
/// changes from the previous one to the next.
///
///     ca.pem       authorities that are trusted, first the one that issues
///     ca.key       its key; may be kept elsewhere
///     crossed.pem  while there are two: the first one's key, vouched for by the second; nothing
///                  vouches for the second one's key, so that it counts for nothing once retired
///     previous.key while there are two: the key of the second, which still issues the server's
///                  certificate
///     retired-F.key that of the authority with fingerprint F
///
/// A change that was interrupted may be made again, and no key of a trusted authority is lost by
/// it.
///
/// Each function throws Failure that names the file and what to do.
class AuthorityFolder {
 public:
  /// Makes the folder with its first authority.
  static AuthorityFolder init(const std::filesystem::path& folder, std::chrono::sys_seconds now);

  /// \param key  file of the issuing authority's key; empty: ca.key.
  /// \throws Failure(NotFound) if it is no such folder.
  explicit AuthorityFolder(std::filesystem::path folder, std::filesystem::path key = {});

  /// Certificates of all, first the one that issues.
  std::vector<Certificate> trusted() const;
  bool has_two() const { return trusted().size() > 1; }

  /// Who vouches for clients: the one that issues. It signs everybody's documents: while there are
  /// two, who trusts one of them only can verify these.
  Vouchers for_clients() const { return vouchers(0); }
  /// For the server, whose certificate clients with files by either authority have to trust: while
  /// there are two, the previous one issues it.
  Vouchers for_server() const { return vouchers(trusted().size() - 1); }

  /// A second authority, which issues from now on.
  /// \throws Failure(Conflict) if there are two.
  void add_second(std::chrono::sys_seconds now);

  /// Only the issuing authority is left; the key of the previous one is kept under another name.
  /// \return that file; empty if the key is kept elsewhere.
  /// \throws Failure(Conflict) if there is one only.
  std::filesystem::path retire_previous();

  /// A new authority in the place of all that there are, whose keys are not asked for.
  void replace(std::chrono::sys_seconds now);

 private:
  std::filesystem::path list_file() const { return folder_ / "ca.pem"; }
  std::filesystem::path key_file() const { return folder_ / "ca.key"; }
  std::filesystem::path crossed_file() const { return folder_ / "crossed.pem"; }
  std::filesystem::path previous_key_file() const { return folder_ / "previous.key"; }
  std::filesystem::path next_key_file() const { return folder_ / "next.key"; }

  Key key_of(x509_st& certificate) const;
  void name_keys() const;
  std::filesystem::path set_aside(x509_st& certificate) const;
  Authority authority(std::size_t number) const;
  Vouchers vouchers(std::size_t issuer) const;

  std::filesystem::path folder_;
  std::filesystem::path key_;
};

}  // namespace kinship::security
