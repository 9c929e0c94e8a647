#pragma once

#include <vector>

#include "server/store/sqlite/prepared_attempt.hpp"
#include "server/store/sqlite/writer.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// A client's batch of attempts on its way through the writer. One bad attempt is refused alone.
class ReportItem : public WriteItem {
 public:
  /// Encodes and hashes on the caller's thread, which spares the writer's.
  ReportItem(std::vector<Attempt> attempts, Store::ReportsDone done);

  std::size_t weight() const override { return receipts_.size(); }
  void apply(Batch& batch) override;
  void finish(const Error* error) override;

 private:
  std::vector<std::optional<PreparedAttempt>> prepared_;  // empty: refused already
  std::vector<Receipt> receipts_;
  Store::ReportsDone done_;
};

}  // namespace kinship::store
