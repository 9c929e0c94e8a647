#pragma once

#include <chrono>
#include <filesystem>
#include <functional>

#include "proto/types/uuid.hpp"

namespace kinship::link {

/// Reports of an outbox that have their receipts, kept for a server whose store loses them again.
///
/// They come into `sent/`. When that has been filled for seven days, or holds 250 000, what is in
/// `sent_before/` is deleted and `sent/` takes its place: each report is kept for seven days at
/// least, unless there are so many. Only time counts in which somebody sends, measured by a clock
/// that nobody sets: robots start in 1970 and hear the time later. Methods throw Failure(Storage)
/// naming the file; all but the constructor are for the holder of the sender lock.
class SentReports {
 public:
  /// \param outbox  the folder of the outbox.
  explicit SentReports(std::filesystem::path outbox);

  void make_folders() const;  ///< if they are missing, durably

  std::filesystem::path file(const Uuid& report_uuid) const;  ///< where one belongs

  /// Calls `visit` with each, which may move it.
  void for_each(const std::function<void(const std::filesystem::path&)>& visit) const;

  /// \param sending  how long somebody has been sending since the last call.
  void age(std::chrono::milliseconds sending) const;

 private:
  void rotate() const;

  std::filesystem::path outbox_;
};

}  // namespace kinship::link
