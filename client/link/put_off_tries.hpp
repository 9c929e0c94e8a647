#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "proto/types/uuid.hpp"

namespace kinship::link {

/// When a report is set aside that the server puts off again and again while it takes others. A
/// server that takes nothing, for however long, is no reason.
struct SetAsideRule {
  static constexpr std::uint64_t kTries = 10;
  static constexpr std::chrono::hours kAge{24};
  static constexpr std::chrono::hours kLongestStep{1};

  std::uint64_t tries = kTries;  ///< answers "try again", each while others of its batch were taken
  /// Time between these by the wall clock, of each two of them kLongestStep at most: a robot's
  /// clock jumps.
  std::chrono::hours age = kAge;
  std::function<std::int64_t()> unix_ms = [] {
    return std::chrono::duration_cast<std::chrono::milliseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
};

/// How often the server put a report of an outbox off, in its file `put_off`: a line
/// "UUID TRIES AGE_MS LAST_MS" each. What a killed process has not written is counted again. For
/// the holder of the sender lock; never throws: with a full disk a report is tried more often.
class PutOffTries {
 public:
  PutOffTries(const std::filesystem::path& outbox, SetAsideRule rule);

  void load();  ///< once the lock is held
  void save();  ///< if something has changed
  void forget(const Uuid& report_uuid);

  /// The server put a report off and took others of its batch. \return why it is to be set aside
  /// now; empty: it is not.
  std::string put_off(const Uuid& report_uuid, const std::string& why);

 private:
  struct Tries {
    std::uint64_t count = 0;
    std::int64_t age_ms = 0;
    std::int64_t last_ms = 0;  ///< by the wall clock
  };
  const std::filesystem::path file_;
  const SetAsideRule rule_;
  std::map<Uuid, Tries> tries_;
  bool has_changed_ = false;
};

}  // namespace kinship::link
