#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "proto/security/client_record.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// The records of DIR/clients as the server asks for them with every request: from memory, and a
/// record that was changed, came or went is noticed a second later at most. May be shared between
/// threads.
class ClientDirectory {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// \param folder  DIR/clients; need not be there yet.
  explicit ClientDirectory(
      std::filesystem::path folder, Clock clock = [] { return std::chrono::steady_clock::now(); });
  ~ClientDirectory();

  /// The record of a client, also of a revoked or expired one.
  /// \return Failure(NotFound) if there is none, Failure(InvalidInput) for a name or a record that
  ///         cannot be: who has no valid record has no rights.
  Result<ClientRecord> find(const std::string& name) const;

  /// What a request with a certificate may do: its client's rights, or why none at `now`.
  /// \param common_name  see CertificateName.
  Result<Caller> caller(const std::string& common_name, std::chrono::sys_seconds now) const;

 private:
  struct Entry;

  Result<ClientRecord> read(const std::filesystem::path& file, const std::string& name) const;

  std::filesystem::path folder_;
  Clock clock_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::unique_ptr<Entry>> entries_;  // guarded by mutex_
};

}  // namespace kinship::security
