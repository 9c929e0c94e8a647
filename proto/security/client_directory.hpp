#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "proto/security/client_record.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// Cache of the records of DIR/clients, which the server looks up with every request: a changed,
/// new or removed record is noticed within a second. A remembered revocation holds, whatever the
/// record says: it may have been put back from a copy. May be shared between threads.
class ClientDirectory {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// \param folder  DIR/clients; need not exist yet.
  explicit ClientDirectory(
      std::filesystem::path folder, Clock clock = [] { return std::chrono::steady_clock::now(); });
  ~ClientDirectory();

  /// The record of a client, also of a revoked or expired one.
  /// \return Failure(NotFound) if there is none, Failure(InvalidInput) for an invalid name or
  ///         record: a client without a valid record has no rights.
  Result<ClientRecord> find(const std::string& name) const;

  /// The rights of a certificate's client, or why it has none at `now`.
  /// \param common_name  see CertificateName.
  Result<Caller> caller(const std::string& common_name, std::chrono::sys_seconds now) const;

  void remember(const Revocation& revocation);

  /// How the records differ from what is remembered.
  struct Differences {
    std::vector<Revocation> unknown;   ///< told by a record, not remembered
    std::vector<Revocation> put_back;  ///< remembered, and its record tells less
  };
  /// Records that cannot be read are passed over: their clients have no rights.
  Differences compare_records() const;

 private:
  struct Entry;

  /// \param fresh_for  what was looked at within that time is not looked at again.
  Result<ClientRecord> find(const std::string& name, std::chrono::seconds fresh_for) const;
  Result<ClientRecord> read(const std::filesystem::path& file, const std::string& name) const;
  /// Of a client; nothing is taken from it: a default one.
  Revocation remembered(const std::string& name) const;

  std::filesystem::path folder_;
  Clock clock_;
  mutable std::mutex mutex_;
  // Both guarded by mutex_.
  mutable std::map<std::string, std::unique_ptr<Entry>> entries_;
  std::map<std::string, Revocation> remembered_;
};

}  // namespace kinship::security
