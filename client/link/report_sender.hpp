#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/link/outbox.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"

namespace kinship::link {

/// Sends what is pending in an outbox, on a thread of its own, until each report has its receipt.
/// May be shared between threads.
class ReportSender {
 public:
  /// Hands a batch to the server and waits for its receipts, for a bounded time.
  using Send = std::function<Result<ReportReply>(const ReportRequest&)>;

  struct Counts {
    std::size_t accepted = 0;  ///< receipts stored, duplicate or recorded
    std::size_t refused = 0;   ///< refused by the server or unreadable on disk
    std::string problem;       ///< why it does not get on; empty: nothing known
  };

  /// \param outbox  must outlive the sender.
  ReportSender(Outbox& outbox, Send send);
  ~ReportSender();  ///< waits for the batch under way; `send` should be made to end before
  ReportSender(const ReportSender&) = delete;
  ReportSender& operator=(const ReportSender&) = delete;

  void wake();  ///< there is something new in the outbox
  Counts counts() const;

  /// Waits until nothing is pending, also if another process sends, or the time has come.
  void wait_until_empty(std::chrono::steady_clock::time_point deadline);

 private:
  void run();
  std::chrono::milliseconds work(std::optional<SenderLock>& lock);
  bool send_all_pending();
  bool send_batch(const ReportRequest& batch);
  void apply(const Receipt& receipt);
  void report_problem(const std::string& problem);
  bool is_stopped() const;

  Outbox& outbox_;
  Send send_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  Counts counts_;
  bool is_woken_ = false;
  bool is_stopped_ = false;
  std::thread thread_;  // last: uses the others
};

}  // namespace kinship::link
