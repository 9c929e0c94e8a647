#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "client/link/outbox.hpp"
#include "client/link/put_off_tries.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"

namespace kinship::files {
class LockFile;
}

namespace kinship::link {

/// Sends the pending reports of an outbox, on its own thread, until each has its receipt. May be
/// shared between threads.
class ReportSender {
 public:
  /// Sends a batch to the server and waits for its receipts, for a bounded time.
  using Send = std::function<Result<ReportReply>(const ReportRequest&)>;

  /// Registers a robot, for a bounded time.
  using Register = std::function<Result<RegisterReply>(const RobotDescription&)>;
  using Now = std::function<std::chrono::steady_clock::time_point()>;

  /// How many servers have come so far (Requester::count_servers).
  using CountServers = std::function<std::uint64_t()>;

  struct Counts {
    std::size_t accepted = 0;   ///< receipts stored, duplicate or recorded
    std::size_t refused = 0;    ///< refused by the server or damaged on disk
    std::string last_refusal;   ///< why; empty: none was
    std::size_t set_aside = 0;  ///< put off by the server again and again (SetAsideRule)
    std::size_t passed_by = 0;  ///< on disk, but they cannot be read; others go
    std::string problem;        ///< why sending fails; empty: no known problem
  };

  /// \param outbox          must outlive the sender.
  /// \param register_robot  called on the sender's thread for robots that the server does not know
  ///                        and the outbox has a description of, and for those with contents of
  ///                        meshes in the outbox when a server comes, and each minute until it has
  ///                        them; empty: they wait.
  /// \param now             the time by which `sent/` grows older.
  /// \param count_servers   a new server is probed if nothing is pending, and every server now and
  ///                        then: its reply shows whether its store has lost sent reports. Empty:
  ///                        no probes.
  /// \param set_aside       when a report is set aside.
  ReportSender(Outbox& outbox, Send send, Register register_robot = {},
               Now now = std::chrono::steady_clock::now, CountServers count_servers = {},
               SetAsideRule set_aside = {});
  ~ReportSender();  ///< waits for the call under way; cancel that call first
  ReportSender(const ReportSender&) = delete;
  ReportSender& operator=(const ReportSender&) = delete;

  void wake();   ///< the outbox has a new report
  void retry();  ///< sends at once, also during a pause: the server has changed
  Counts counts() const;

  /// Waits until nothing is pending but what cannot be read, also if another process sends, or the
  /// deadline has passed.
  void wait_until_empty(std::chrono::steady_clock::time_point deadline);

 private:
  void run();
  std::chrono::milliseconds work(std::optional<files::LockFile>& lock);
  void age_now_and_then(bool is_end);
  bool send_all_pending();
  bool notes_store_first();
  bool probe_epoch();
  void send_contents();
  Result<ReportReply> exchange(ReportRequest& batch);
  bool deliver(ReportRequest& batch);
  bool send_batch(ReportRequest& batch);
  bool register_robots(const ReportRequest& batch);
  void apply(const Receipt& receipt);
  void pass_by(const Uuid& report_uuid, const std::string& why);
  bool is_passed_by(const Uuid& report_uuid) const;
  void read_on(const Uuid& report_uuid);
  bool is_anything_to_send() const;
  std::map<Uuid, Receipt> final_receipts(const ReportReply& reply, std::string& problem);
  std::vector<Uuid> in_turn();
  void report_problem(const std::string& problem);
  bool is_stopped() const;

  Outbox& outbox_;
  const Send send_;
  const Register register_robot_;
  const Now now_;
  const CountServers count_servers_;
  // Of the thread alone:
  std::optional<std::chrono::steady_clock::time_point> aged_;
  std::optional<std::chrono::steady_clock::time_point> probed_;  // the last reply, also a receipt's
  std::uint64_t servers_probed_ = 0;
  std::uint64_t servers_with_contents_ = 0;  ///< that came before contents were sent last
  std::optional<std::chrono::steady_clock::time_point> contents_left_;  // the last did not get all
  bool is_resending_ = false;              // sent reports are pending again
  RetryAfter retry_after_{0};              // requested by the server in this round
  std::set<Digest> unknown_;               // robots whose reports wait for the next round
  std::map<Digest, std::string> refused_;  // robots that the server will not have, and why
  PutOffTries tries_;
  std::uint64_t round_ = 0;
  // Reports that the server put off when they were sent last, and the round of that: the others go
  // first, then those that have waited longest.
  std::map<Uuid, std::uint64_t> put_off_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  Counts counts_;
  std::map<Uuid, std::chrono::steady_clock::time_point> passed_by_;  // until when
  std::string last_passed_by_, last_set_aside_;                      // and why
  bool is_woken_ = false;
  bool is_retry_due_ = false;
  bool is_stopped_ = false;
  std::thread thread_;  // last: uses the others
};

}  // namespace kinship::link
