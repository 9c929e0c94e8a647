#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/service/job_rows.hpp"
#include "server/store/page.hpp"

namespace kinship::service {

/// True for a job that neither waits nor runs.
bool has_ended(JobState state) noexcept;

/// The context of a running job, on the thread of the jobs.
class JobRun {
 public:
  JobRun(std::stop_token stop, std::size_t max_row_bytes)
      : rows(max_row_bytes), stop_(std::move(stop)) {}

  bool should_stop() const { return stop_.stop_requested(); }
  const std::stop_token& stop_token() const noexcept { return stop_; }
  void set_progress(double progress) noexcept { progress_ = progress; }  ///< 0 to 1
  double progress() const noexcept { return progress_; }

  JobRows rows;         ///< read by JobRows of the admin conversation once the job is done
  std::string message;  ///< its result, as text

 private:
  std::stop_token stop_;
  std::atomic<double> progress_{0};
};

/// Runs long verbs: a bounded queue, one job at a time on a thread of their own; ended jobs are
/// kept for a while. May be shared between threads.
class Jobs {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  struct Limits {
    std::size_t queued = 16;                          ///< that wait; more are refused
    std::size_t client_active = 2;                    ///< of one client, not ended; 0: any number
    std::size_t kept = 64;                            ///< ended ones
    std::size_t client_kept = 32;                     ///< ended ones of one client
    std::chrono::milliseconds kept_for{3'600'000};    ///< from its end
    std::size_t row_bytes = std::size_t{64} << 20U;   ///< of one job's rows
    std::size_t kept_bytes = std::size_t{64} << 20U;  ///< of the rows of all ended jobs together
    std::size_t waiters = 256;
  };

  struct Options {
    Limits limits;
    int niceness = 10;
    /// Called when a job has ended, on the thread that ended it.
    std::function<void(const Job&)> on_end = [](const Job&) {};
  };

  /// A long verb to run.
  struct Task {
    std::string verb, argument;
    /// Key of its request. A request sent again, e.g. after a lost reply, begins no second job;
    /// empty: it is never sent again.
    std::string request_key;
    std::string owner = {};  ///< the client that begins it; empty: none, without a quota
    /// Called once with the ended job, before any other callback: by the thread that runs it, in
    /// cancel() or in stop(). It must not throw.
    std::function<void(const Job&)> on_end = [](const Job&) {};
    /// \return false if it ended early because it should stop. An exception makes it Failed.
    std::function<bool(JobRun&)> run;
  };

  Jobs(const runtime::Clock& clock, Options options);
  ~Jobs() { stop(); }
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  /// \return the job's current state; Unavailable, with the limit, if too many wait, of its owner
  ///         or in all, or if jobs stop.
  Result<Job> begin(Task task);
  /// The error that begin() would return for an owner now.
  std::optional<Error> refusal_of(const std::string& owner) const;

  std::optional<Job> begun_by(const std::string& request_key) const;
  /// Jobs, the latest first. The oldest are forgotten first: a page after a forgotten job is empty.
  /// \param cursor  of the page before; empty: the first page.
  store::Page<Job> list(const std::string& cursor, std::size_t limit) const;
  Result<Job> find(const std::string& id) const;  ///< NotFound
  std::optional<std::string> owner_of(const std::string& id) const;
  std::size_t active() const;  ///< not ended

  /// Ends a queued job at once and frees its place, a running one soon. A job that finishes before
  /// it notices is Done. Ended jobs stay as they are. \return the job's current state; NotFound.
  Result<Job> cancel(const std::string& id);

  /// Rows of a done job, from row `first` on; at most `limit`, and `max_bytes` together, but at
  /// least one. \return InvalidInput, with its state, for any other job; NotFound.
  struct RowPage {
    std::vector<std::string> rows;
    std::size_t next = 0;  ///< 0: no more
  };
  Result<RowPage> rows(const std::string& id, std::size_t first, std::size_t limit,
                       std::size_t max_bytes) const;

  /// `done` is called once with the job's current state when it has ended or `deadline` has come:
  /// on this thread, the jobs' own, in cancel(), expire() or stop(). It must not throw or block.
  using Done = std::function<void(const Result<Job>&)>;
  void wait(const std::string& id, TimePoint deadline, Done done);

  /// When expire() is due next; empty: not before the next call.
  std::optional<TimePoint> next_deadline() const;
  /// Answers waiters whose deadline has come and forgets jobs kept for `kept_for`.
  void expire(TimePoint now);

  /// Cancels all jobs and returns when the running one has ended. A second call returns at once.
  void stop();

 private:
  struct Entry;
  using EntryPointer = std::shared_ptr<Entry>;  // shared with the thread that runs it
  struct Waiter {
    std::string id;
    TimePoint deadline;
    Done done;
  };
  /// Callbacks to make once no lock is held.
  struct Calls {
    std::vector<std::pair<std::function<void(const Job&)>, Job>> ended;
    std::vector<std::pair<Done, Job>> answers;
  };

  void work();
  EntryPointer next();
  void run(const EntryPointer& entry);
  void make(const Calls& calls) const;

  // With the lock held.
  EntryPointer find_entry(const std::string& id) const;
  EntryPointer find_begun(const std::string& request_key) const;
  std::string new_id() const;
  std::size_t count(JobState state) const;
  std::optional<Error> find_refusal(const std::string& owner) const;
  void end(Entry& entry, JobState state, const std::string& message, Calls& calls);
  void forget_old(TimePoint now);

  const runtime::Clock& clock_;
  const Options options_;

  mutable std::mutex mutex_;          // guards what follows, but for the worker
  std::deque<EntryPointer> entries_;  // as begun; queued ones wait in this order
  std::vector<Waiter> waiters_;
  bool is_working_ = false;
  bool is_stopping_ = false;
  runtime::WorkerPool worker_;  // last: its thread uses all of the above
};

}  // namespace kinship::service
