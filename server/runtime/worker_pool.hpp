#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/runtime/fair_queue.hpp"

namespace kinship::runtime {

/// A fixed number of threads and a bounded queue: interactive jobs before background ones, each
/// kind of each client in turn (fair_queue.hpp). May be shared between threads.
class WorkerPool {
 public:
  struct Options {
    std::size_t threads = 1;
    std::size_t queue_limit = 64;  ///< jobs that wait, of both kinds
    int niceness = 0;              ///< 0 to 19, of each thread; 19 yields most
    std::size_t client_limit = 0;  ///< interactive ones of one client that wait; 0: no limit
  };

  enum class Priority { Interactive, Background };

  /// Exactly one of the two is called, on a worker or in stop(). Neither may throw; one that finds
  /// no memory even for its answer is dropped.
  struct Job {
    std::function<void()> run;
    std::function<void()> abandon;  ///< may be empty
    std::string client = {};        ///< its client; empty: the server itself, without a limit
  };

  /// Treatment by stop() of jobs not yet begun.
  enum class Leftovers { Run, Abandon };

  /// \throws Failure(Internal) if the operating system has no room for that many threads.
  explicit WorkerPool(const Options& options);
  ~WorkerPool();  ///< stop(Leftovers::Abandon)
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// \return false, with the job untouched, if the queue is full, also for its client, or the pool
  ///         stops.
  bool submit(Priority priority, Job job);

  /// Accepts no more jobs, runs or abandons the queue, and returns when every thread has ended. Not
  /// to be called from a job. A second call returns at once.
  void stop(Leftovers leftovers);

  std::size_t queued() const;                              ///< jobs not yet begun
  std::size_t queued_of(const std::string& client) const;  ///< interactive ones
  std::size_t threads() const noexcept { return thread_count_; }

 private:
  void work(int niceness);
  bool next_job(Job& job);

  const std::size_t queue_limit_, client_limit_;
  const std::size_t thread_count_;
  mutable std::mutex mutex_;  // guards what follows, but for the threads
  std::condition_variable wake_;
  FairQueue<Job> interactive_, background_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;  // changed by the constructor and by the first stop() only
};

}  // namespace kinship::runtime
