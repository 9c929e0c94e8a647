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

/// Cache of the records of DIR/clients, which the server looks up with every request: a changed,
/// new or removed record is noticed within a second. May be shared between threads.
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

 private:
  struct Entry;

  Result<ClientRecord> read(const std::filesystem::path& file, const std::string& name) const;

  std::filesystem::path folder_;
  Clock clock_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::unique_ptr<Entry>> entries_;  // guarded by mutex_
};

}  // namespace kinship::security
