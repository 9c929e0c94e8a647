#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <thread>

#include "proto/types/conversations.hpp"
#include "proto/types/summaries.hpp"
#include "server/metrics/histogram.hpp"
#include "server/runtime/clock.hpp"

namespace kinship::service {

/// Outcome of a fetch: the FetchStatus, and the source of a distribution.
enum class FetchOutcome : std::uint8_t {
  Memory,  ///< answered at once with a distribution
  Store,   ///< one that was not in memory
  Fitted,  ///< one that was fitted meanwhile
  Pending,
  NoExperience,
  UnknownRobot,
  Busy,
  Refused,
  Failed,
};

inline constexpr std::array<std::string_view, 9> kFetchOutcomeNames = {
    "memory",        "store", "fitted",  "pending", "no_experience",
    "unknown_robot", "busy",  "refused", "failed"};

/// In the order of ReceiptStatus.
inline constexpr std::array<std::string_view, 6> kReceiptNames = {
    "stored", "duplicate", "recorded", "refused", "try_again", "unknown_robot"};

/// One fetch in progress: its arrival time, and whether the catalog answered it at once, i.e. on
/// the requesting thread (a worker may be done before the catalog's fetch() returns). Made by the
/// requesting thread; used by it and by the answering thread.
class FetchWatch {
 public:
  explicit FetchWatch(const runtime::Clock& clock)
      : clock_(clock), began_(clock.now()), began_ms_(clock.unix_ms()) {}

  void set_asked() noexcept { is_asked_ = true; }  ///< the catalog's fetch() has returned
  void set_answered() noexcept {                   ///< the catalog has answered
    is_at_once_ = !is_asked_ && std::this_thread::get_id() == asking_;
  }

  /// Outcome of a fetch that is answered with `reply` now.
  FetchOutcome outcome(const FetchReply& reply) const;
  std::chrono::steady_clock::duration age() const { return clock_.now() - began_; }

 private:
  const runtime::Clock& clock_;
  const std::chrono::steady_clock::time_point began_;
  const std::int64_t began_ms_;
  const std::thread::id asking_ = std::this_thread::get_id();
  std::atomic<bool> is_asked_ = false, is_at_once_ = false;
};

/// Counters and histograms of a service. Each may be used by any thread.
struct Measures {
  metrics::Histogram receipts;  ///< from a batch to its receipts
  std::array<metrics::Counter, kReceiptNames.size()> attempts;
  std::array<metrics::Histogram, kFetchOutcomeNames.size()> fetches;
  metrics::Histogram transfers, fits;    ///< duration of each that made a distribution
  metrics::Counter failed_fits;          ///< that made none, for a known reason
  std::array<metrics::Counter, 3> jobs;  ///< ended: Done, Failed, Cancelled

  void count(const FetchReply& reply, const FetchWatch& watch) noexcept;
  void count(std::span<const Receipt> receipts, std::chrono::steady_clock::duration age) noexcept;
  void count(const Distribution& fitted) noexcept;
  void count(const Job& ended) noexcept;
};

}  // namespace kinship::service
