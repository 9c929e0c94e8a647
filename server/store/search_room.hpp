#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <vector>

#include "server/store/replicated_report.hpp"
#include "server/store/report_store.hpp"
#include "server/store/session.hpp"
#include "server/store/tables/searches.hpp"

namespace kinship::store {

/// Says when search records have to be let go, and how many bytes there are, without counting them
/// for each report. May be shared between threads.
class SearchRoom {
 public:
  explicit SearchRoom(const SearchLimits& limits) : limits_(limits) {}

  const SearchLimits& limits() const noexcept { return limits_; }

  /// Takes the records from reports if none is to be kept.
  /// \return whether it is time to let the oldest go: after a part of the limit, or an hour.
  template <typename Reported>
  bool admit(std::vector<Reported>& reports) {
    std::uint64_t bytes = 0;
    for (Reported& report : reports) {
      std::optional<SearchRecord>& search = attempt_of(report).search;
      if (limits_.bytes == 0)
        search.reset();
      else if (search)
        bytes += kinship::search_bytes(*search);
    }
    return bytes > 0 && is_trim_due(bytes);
  }

  /// Bytes of all records, about, as of the last seconds.
  std::uint64_t used(Session& session) {
    constexpr std::chrono::seconds kGoodFor{10};
    const std::lock_guard lock(mutex_);
    if (const auto now = Clock::now(); now >= count_again_) {
      used_ = count_search_bytes(session);
      count_again_ = now + kGoodFor;
    }
    return used_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  static Attempt& attempt_of(Attempt& attempt) { return attempt; }
  static Attempt& attempt_of(ReplicatedReport& report) { return report.attempt; }

  bool is_trim_due(std::uint64_t bytes) {
    constexpr std::uint64_t kPart = 32;
    constexpr std::chrono::hours kBetween{1};
    const std::lock_guard lock(mutex_);
    came_ += bytes;
    if (const auto now = Clock::now(); came_ > limits_.bytes / kPart || now >= trim_again_) {
      came_ = 0;
      trim_again_ = now + kBetween;
      return true;
    }
    return false;
  }

  const SearchLimits limits_;
  std::mutex mutex_;
  std::uint64_t came_ = 0;  // since the last trim, guarded by mutex_ like all below
  std::uint64_t used_ = 0;
  Clock::time_point trim_again_{}, count_again_{};
};

}  // namespace kinship::store
