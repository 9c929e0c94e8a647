#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/uuid.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"
#include "server/store/values/put_off_reports.hpp"

namespace kinship::store {

/// A client's batch of attempts in the writer's queue. One that the database does not take is put
/// off alone.
class ReportItem : public WriteItem {
 public:
  /// Encodes and hashes on the caller's thread, which spares the writer's.
  /// \param history  gets the item's position before `done` is called.
  /// \param put_off  keeps the reports that the database does not take. Both outlive the item.
  /// \param max_paths  of a robot and task (rules/report_resolver.hpp); 0: no cap.
  ReportItem(History& history, PutOffReports& put_off, std::vector<Attempt> attempts,
             Store::ReportsDone done, std::uint64_t max_paths = 0);

  /// For reports from another store.
  ReportItem(History& history, PutOffReports& put_off, std::vector<ReplicatedReport> reports,
             Store::ReportsDone done, std::uint64_t max_paths);

  /// For attempts that the queue has no room for: each is answered TryAgain, in order.
  static std::unique_ptr<ReportItem> declined(History& history, PutOffReports& put_off,
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
  PutOffReports& put_off_;
  std::uint64_t position_ = 0;
  std::vector<std::optional<PreparedAttempt>> prepared_;  // empty: answered already
  std::vector<Receipt> receipts_;
  std::size_t bytes_ = 0;
  std::uint64_t max_paths_ = 0;
  Store::ReportsDone done_;
};

}  // namespace kinship::store
