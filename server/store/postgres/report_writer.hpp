#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/opening/history.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/postgres/report_queue.hpp"
#include "server/store/values/put_off_reports.hpp"

namespace kinship::store::postgres {

struct ReportWriterOptions {
  std::uint64_t max_paths_per_pair = 0;
  bool require_synchronous = false;
  std::chrono::milliseconds retry_after{1000};  ///< between two tries to connect again
  std::chrono::milliseconds put_off_for{0};     ///< see PutOffReports
  std::function<void(std::string_view)> log = {};
};

/// Checks that commits on this connection wait for a standby.
/// \throws PostgresError that names the missing setting.
void require_standby(Connection& connection);

/// The thread that writes reports, on a connection of its own. It writes the queued items, up to a
/// cap, in one transaction and answers when the commit is certain, without a timer. While the
/// database does not answer, or lacks a required standby, reports are answered TryAgain, and the
/// thread tries again every `retry_after`. It waits for a commit without limit, as for a standby.
class ReportWriter {
 public:
  /// \param connection  on which a run of the history has begun.
  /// \param connected   called on the writer's thread after each reconnection.
  ReportWriter(Primary& primary, History& history, std::unique_ptr<Connection> connection,
               ReportWriterOptions options, std::function<void(Connection&)> connected);
  ReportWriter(const ReportWriter&) = delete;
  ReportWriter& operator=(const ReportWriter&) = delete;
  /// Writes the queued items. Reports that the database does not take within some seconds are
  /// answered TryAgain.
  ~ReportWriter();

  void submit(QueuedItem item) { queue_.push(std::move(item)); }

  std::size_t queued() const { return queue_.weight(); }
  std::size_t queued_bytes() const { return queue_.bytes(); }
  /// Empty while reports are stored; else the reason why not.
  std::string trouble() const;
  /// The reports that the database did not take.
  PutOffReports& put_off() noexcept { return put_off_; }

  /// Ends the waits of the connection: the interrupt that `primary` was made with.
  void set_interrupt(Interrupt& interrupt) noexcept { interrupt_ = &interrupt; }

 private:
  /// An attempt being written, and the place of its receipt.
  struct Pending {
    const PreparedAttempt* prepared = nullptr;
    Receipt* receipt = nullptr;
  };

  void run();
  bool run_once();
  void write(std::vector<QueuedItem>& items);
  void write_reports(std::span<Pending> pending);
  bool try_reports(std::span<Pending> pending);
  void write_alone(const std::function<void(Connection&)>& write);
  bool is_connected();
  void look_around();
  void give_up(const std::string& why);
  void note(const std::string& why);
  static void answer(std::span<Pending> pending, const std::string& why);

  Primary& primary_;
  History& history_;
  const ReportWriterOptions options_;
  PutOffReports put_off_;
  const std::function<void(Connection&)> connected_;
  Interrupt* interrupt_ = nullptr;
  ReportQueue queue_;
  // The writer's thread only:
  std::unique_ptr<Connection> connection_;  // empty: lost
  std::chrono::steady_clock::time_point next_try_ = {};

  std::atomic<std::int64_t> waits_since_ms_ = 0;  // for a COMMIT; 0: it does not
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  std::string trouble_;     // guarded by mutex_
  bool has_ended_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace kinship::store::postgres
