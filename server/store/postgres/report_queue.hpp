#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/values/prepared_attempt.hpp"
#include "server/store/values/put_off_reports.hpp"

namespace kinship::store::postgres {

/// An item of the queue: a client's batch of attempts, or a write without a waiting caller.
struct QueuedItem {
  std::vector<std::optional<PreparedAttempt>> prepared;  ///< empty: answered already
  std::vector<Receipt> receipts;                         ///< one an attempt
  Store::ReportsDone done;                               ///< empty: not of reports
  std::function<void(Connection&)> write;                ///< in a transaction of its own
  std::size_t bytes = 0;

  std::size_t weight() const { return receipts.empty() ? 1 : receipts.size(); }
};

/// Encodes and hashes on the caller's thread, which spares the writer's. Refuses attempts that
/// cannot be stored; those that are put off are answered so.
QueuedItem prepare_item(std::vector<Attempt> attempts, Store::ReportsDone done,
                        PutOffReports& put_off);

/// The same for reports from another store.
QueuedItem prepare_item(std::vector<ReplicatedReport> reports, Store::ReportsDone done,
                        PutOffReports& put_off);

/// For reports that the queue has no room for: each is answered TryAgain, in order.
QueuedItem declined_item(const std::vector<Uuid>& reports, Store::ReportsDone done,
                         const std::string& why);

/// The queue of the thread that writes. May be shared between threads.
class ReportQueue {
 public:
  void push(QueuedItem item);

  /// Waits for items, at most a second, and takes the items of one transaction.
  /// \return nothing once the queue is closed and empty.
  std::optional<std::vector<QueuedItem>> take();
  void close();

  std::size_t weight() const;
  std::size_t bytes() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<QueuedItem> items_;  // guarded by mutex_, like all below
  std::size_t weight_ = 0;
  std::size_t bytes_ = 0;
  bool is_closed_ = false;
};

}  // namespace kinship::store::postgres
