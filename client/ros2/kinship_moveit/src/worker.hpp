#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace kinship_moveit {

/// A thread that does jobs one after the other, so that planning waits for none of them. Its
/// destructor does what was posted before, and joins.
class Worker {
 public:
  Worker() : thread_([this] { run(); }) {}
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() {
    {
      const std::scoped_lock lock(mutex_);
      is_over_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  /// \return false, and the job is not taken, if too many wait. \param job  must not throw.
  bool post(std::function<void()> job) {
    constexpr std::size_t kMost = 1000;
    {
      const std::scoped_lock lock(mutex_);
      if (jobs_.size() >= kMost)
        return false;
      jobs_.push_back(std::move(job));
    }
    changed_.notify_all();
    return true;
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return is_over_ || !jobs_.empty(); });
      if (jobs_.empty())
        return;
      const std::function<void()> job = std::move(jobs_.front());
      jobs_.pop_front();
      lock.unlock();
      job();
      lock.lock();
    }
  }

  std::mutex mutex_;  // guards the next two
  std::deque<std::function<void()>> jobs_;
  bool is_over_ = false;
  std::condition_variable changed_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace kinship_moveit
