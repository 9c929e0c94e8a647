#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "proto/types/uuid.hpp"

namespace kinship::store {

/// The reports that could not be written because of damage, and why. Their clients send them again
/// and again: for a while they are answered without a look at the disk, and without a second try of
/// the batch that they came with. May be shared between threads.
class DamagedReports {
 public:
  using Clock = std::chrono::steady_clock;

  void note(const Uuid& report_uuid, const std::string& why, Clock::time_point now = Clock::now());
  /// Why it could not be written; nothing if that is long ago.
  std::optional<std::string> find(const Uuid& report_uuid, Clock::time_point now = Clock::now());

  static constexpr std::chrono::seconds kRemembered{10};
  static constexpr std::size_t kMaxReports = 4096;  ///< beyond it the memory begins anew

 private:
  struct Noted {
    std::string why;
    Clock::time_point until;
  };
  std::mutex mutex_;
  std::map<Uuid, Noted> reports_;  // guarded by mutex_
};

}  // namespace kinship::store
