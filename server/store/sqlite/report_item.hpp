#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/uuid.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"

namespace kinship::store {

/// The reports that could not be written because of damage, with the reasons. Their clients keep
/// resending them: for a while they are answered without reading the disk, and without a second try
/// of their batch. May be shared between threads.
class DamagedReports {
 public:
  using Clock = std::chrono::steady_clock;

  void note(const Uuid& report_uuid, const std::string& why, Clock::time_point now = Clock::now());
  /// The reason why a report could not be written; nothing if it is none or too old.
  std::optional<std::string> find(const Uuid& report_uuid, Clock::time_point now = Clock::now());

  static constexpr std::chrono::seconds kRemembered{10};
  static constexpr std::size_t kMaxReports = 4096;  ///< beyond it all are forgotten

 private:
  struct Noted {
    std::string why;
    Clock::time_point until;
  };
  std::mutex mutex_;
  std::map<Uuid, Noted> reports_;  // guarded by mutex_
};

/// A client's batch of attempts in the writer's queue. One bad attempt is refused alone.
class ReportItem : public WriteItem {
 public:
  /// Encodes and hashes on the caller's thread, which spares the writer's.
  /// \param history  gets the item's position before `done` is called.
  /// \param damaged  keeps the reports that cannot be written because of damage. Both outlive the
  ///                 item.
  /// \param max_paths  of a robot and task (rules/report_resolver.hpp); 0: no cap.
  ReportItem(History& history, DamagedReports& damaged, std::vector<Attempt> attempts,
             Store::ReportsDone done, std::uint64_t max_paths = 0);

  /// For reports from another store.
  ReportItem(History& history, DamagedReports& damaged, std::vector<ReplicatedReport> reports,
             Store::ReportsDone done, std::uint64_t max_paths);

  /// For attempts that the queue has no room for: each is answered TryAgain, in order.
  static std::unique_ptr<ReportItem> declined(History& history, DamagedReports& damaged,
                                              const std::vector<Uuid>& reports,
                                              Store::ReportsDone done, const std::string& why);

  std::size_t weight() const override { return receipts_.size(); }
  std::size_t bytes() const override { return bytes_; }
  void apply(Batch& batch) override;
  void finish(const Error* error) override;

 private:
  template <typename Reported>
  void take(const Uuid& report_uuid, Reported reported);

  History& history_;
  DamagedReports& damaged_;
  std::uint64_t position_ = 0;
  std::vector<std::optional<PreparedAttempt>> prepared_;  // empty: answered already
  std::vector<Receipt> receipts_;
  std::size_t bytes_ = 0;
  std::uint64_t max_paths_ = 0;
  Store::ReportsDone done_;
};

}  // namespace kinship::store
