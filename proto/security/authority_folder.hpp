#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

#include "proto/security/signed_document.hpp"

namespace kinship::security {

/// The authorities of a fleet and their keys: DIR/authority. Mostly one; two while the fleet
/// changes from the previous one to the next.
///
///     ca.pem       authorities that are trusted, first the one that issues
///     ca.key       its key; may be kept elsewhere
///     crossed.pem  while there are two: each of them, issued by the other
///     previous.key while there are two: the key of the second, which still issues the server's
///                  certificate
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

  /// Who issues the certificates of clients.
  Authority for_clients() const;
  /// Who issues that of the server, which clients with files by either authority have to trust:
  /// while there are two, the previous one.
  Authority for_server() const;
  /// trusted(), as a participant wants it that the authority vouches for: that one first.
  std::vector<Certificate> trusted_by(const Authority& authority) const;

  /// A second authority, which issues from now on.
  /// \throws Failure(Conflict) if there are two.
  void add_second(std::chrono::sys_seconds now);

  /// Only the issuing authority is left; the key of the previous one is kept under another name.
  /// \return that file; empty if the key is kept elsewhere.
  /// \throws Failure(Conflict) if there is one only.
  std::filesystem::path retire_previous();

 private:
  std::filesystem::path list_file() const { return folder_ / "ca.pem"; }
  std::filesystem::path crossed_file() const { return folder_ / "crossed.pem"; }
  std::filesystem::path previous_key_file() const { return folder_ / "previous.key"; }
  std::filesystem::path next_key_file() const { return folder_ / "next.key"; }

  Key key_of(x509_st& certificate) const;
  Authority authority(std::size_t number) const;

  std::filesystem::path folder_;
  std::filesystem::path key_;
};

}  // namespace kinship::security
