#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/store/sqlite/damaged_reports.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"

namespace kinship::store {

/// A client's batch of attempts on its way through the writer. One bad attempt is refused alone.
class ReportItem : public WriteItem {
 public:
  /// Encodes and hashes on the caller's thread, which spares the writer's.
  /// \param history  told how far the item brought it, before `done` is called.
  /// \param damaged  where reports that damage keeps out are remembered. Both outlive the item.
  /// \param max_paths  of a robot and task (rules/report_resolver.hpp); 0: no cap.
  ReportItem(History& history, DamagedReports& damaged, std::vector<Attempt> attempts,
             Store::ReportsDone done, std::uint64_t max_paths = 0);

  /// Of what another store has.
  ReportItem(History& history, DamagedReports& damaged, std::vector<SharedReport> reports,
             Store::ReportsDone done, std::uint64_t max_paths);

  /// For attempts that there is no room to queue: each is answered TryAgain, in turn.
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
