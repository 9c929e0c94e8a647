#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "proto/types/uuid.hpp"

namespace kinship::store {

/// The reports that a database does not take although no rule is against them, with its words: what
/// they are to change is damaged, or a constraint, a trigger or a sequence is in the way. Their
/// clients send them again: for a while they are answered from here, so that the others of their
/// batch are not written twice. May be shared between threads.
class PutOffReports {
 public:
  using Clock = std::chrono::steady_clock;

  /// \param remembered  how long a report is answered from here.
  explicit PutOffReports(std::chrono::milliseconds remembered) : remembered_(remembered) {}

  void note(const Uuid& report_uuid, const std::string& why, Clock::time_point now = Clock::now());
  /// Why a report was put off; nothing if it was not, or too long ago.
  std::optional<std::string> find(const Uuid& report_uuid, Clock::time_point now = Clock::now());

  /// How often since the start, and why the last time: for the status. Empty if never.
  std::string told() const;

  static constexpr std::chrono::milliseconds kRemembered{10'000};
  static constexpr std::size_t kMaxReports = 4096;  ///< beyond it all are forgotten

 private:
  struct Noted {
    std::string why;
    Clock::time_point until;
  };
  const std::chrono::milliseconds remembered_;
  mutable std::mutex mutex_;
  std::map<Uuid, Noted> reports_;  // guarded by mutex_, like all below
  std::uint64_t count_ = 0;
  std::string last_;
};

}  // namespace kinship::store
