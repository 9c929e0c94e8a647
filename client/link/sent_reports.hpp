#pragma once

#include <chrono>
#include <filesystem>
#include <functional>

#include "proto/types/uuid.hpp"

namespace kinship::link {

/// Reports of an outbox that have their receipts, kept in case the server's store loses them.
///
/// They are moved into `sent/`. When that has been filled for seven days, or holds 250 000,
/// `sent_before/` is deleted and `sent/` takes its place: each report is kept for at least seven
/// days, unless there are so many. Only time in which a process sends counts, by the steady clock:
/// robots start in 1970 and learn the time later. Methods throw Failure(Storage) naming the file;
/// all but the constructor are for the holder of the sender lock.
class SentReports {
 public:
  /// \param outbox  the folder of the outbox.
  explicit SentReports(std::filesystem::path outbox);

  void make_folders() const;  ///< if they are missing, durably

  std::filesystem::path file(const Uuid& report_uuid) const;  ///< the place of a report

  /// Calls `visit` with each report's file, which `visit` may move.
  void for_each(const std::function<void(const std::filesystem::path&)>& visit) const;

  /// \param sending  time of sending since the last call.
  void age(std::chrono::milliseconds sending) const;

 private:
  void rotate() const;

  std::filesystem::path outbox_;
};

}  // namespace kinship::link
