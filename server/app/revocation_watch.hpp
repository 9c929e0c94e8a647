#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "proto/security/client_directory.hpp"
#include "proto/security/security_folder.hpp"
#include "server/store/store.hpp"

namespace kinship::app {

/// Keeps revocations of clients for good: what the records of the security folder tell is written
/// to the store's audit log and holds from then on. A record that was put back from a copy is
/// revoked again, and that is told. Entries of a folder with other authorities do not count: its
/// clients are others. Works on a thread of its own.
class RevocationWatch {
 public:
  /// Longest time for which a record that was replaced is not looked at.
  static constexpr std::chrono::seconds kInterval{1};
  /// The same for a record that was written in place, and for the entries of other servers.
  static constexpr std::chrono::seconds kLongInterval{10};

  /// What the log tells is remembered when it returns.
  /// \param clients, store  outlive the watch.
  /// \param warn  called with a line for people, on the watch's thread.
  /// \throws Failure(Storage) if the log cannot be read: a revoked client might be let in.
  RevocationWatch(security::SecurityFolder folder, security::ClientDirectory& clients,
                  store::Store& store, std::function<void(std::string_view)> warn);
  ~RevocationWatch();
  RevocationWatch(const RevocationWatch&) = delete;
  RevocationWatch& operator=(const RevocationWatch&) = delete;

 private:
  void run(const std::stop_token& stop);
  void look();
  void compare_records();
  std::vector<AuditEntry> read_log();  ///< \return all of the server
  void write_log();
  void revoke_again(const std::vector<security::Revocation>& put_back);

  const security::SecurityFolder folder_;
  security::ClientDirectory& clients_;
  store::Store& store_;
  const std::function<void(std::string_view)> warn_;
  // Of the thread, once it runs.
  std::filesystem::file_time_type folder_changed_ = {};
  std::chrono::steady_clock::time_point compared_at_ = {}, read_at_ = {};
  std::set<std::string> authorities_;  // of the folder, and those that it or others had with them
  std::vector<AuditEntry> unwritten_;
  std::set<std::string> told_;  // clients whose records were put back and could not be written
  std::mutex mutex_;
  std::condition_variable_any stopping_;
  std::jthread thread_;  // last: uses all of the above
};

}  // namespace kinship::app
