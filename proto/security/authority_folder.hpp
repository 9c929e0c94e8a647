#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

#include "proto/security/credentials.hpp"

namespace kinship::security {

/// The authorities of a fleet and their keys: DIR/authority. Mostly one; two while the fleet
/// changes from the previous one to the next.
///
///     ca.pem       trusted authorities, the issuing one first
///     ca.key       its key; may be kept elsewhere
///     crossed.pem  while there are two: the first one's key, certified by the second; no
///                  certificate vouches for the second one's key, so that it is worthless once
///                  retired
///     previous.key while there are two: the key of the second, which still issues the server's
///                  certificate
///     retired-F.key that of the authority with fingerprint F
///
/// An interrupted change may be repeated, and loses no key of a trusted authority.
///
/// Each function throws Failure that names the file and a remedy.
class AuthorityFolder {
 public:
  /// Makes the folder with its first authority.
  static AuthorityFolder init(const std::filesystem::path& folder, std::chrono::sys_seconds now);

  /// \param key  file of the issuing authority's key; empty: ca.key.
  /// \throws Failure(NotFound) if it is not such a folder.
  explicit AuthorityFolder(std::filesystem::path folder, std::filesystem::path key = {});

  /// Certificates of all authorities, the issuing one first.
  std::vector<Certificate> trusted() const;
  bool has_two() const { return trusted().size() > 1; }

  /// The authority for clients: the issuing one. It signs all documents: while there are two, a
  /// participant that trusts only one of them can verify these.
  Vouchers for_clients() const { return vouchers(0); }
  /// The authority for the server, whose certificate clients of either authority have to trust:
  /// while there are two, the previous one issues it.
  Vouchers for_server() const { return vouchers(trusted().size() - 1); }

  /// Adds a second authority, which issues from now on.
  /// \throws Failure(Conflict) if there are two.
  void add_second(std::chrono::sys_seconds now);

  /// Removes the previous authority and keeps its key under another name.
  /// \return the file of that key; empty if the key is kept elsewhere.
  /// \throws Failure(Conflict) if there is only one authority.
  std::filesystem::path retire_previous();

  /// Replaces all authorities by a new one; their keys are not needed.
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
