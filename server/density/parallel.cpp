#include "server/density/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace kinship::density {
namespace {

/// Whether a condition that is about to hold did so soon: to be woken costs more than to wait for
/// some microseconds.
template <typename Condition>
bool holds_soon(const Condition& condition) {
  constexpr int kLooks = 1000;
  for (int i = 0; i < kLooks; ++i) {
    if (condition())
      return true;
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
  }
  return condition();
}

/// The threads that help another one, which is the only one to call it. They are started when they
/// are first needed, and wait in between: a fit has hundreds of passes of less than a millisecond.
class Helpers {
 public:
  Helpers() = default;
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;
  ~Helpers() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
      ++calls_;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_)
      thread.join();
  }

  /// Does a work here and, at the same time, by up to `most` helpers; returns when no helper is at
  /// it any more.
  /// \param work  does the rest of something, until nothing is left; does not throw.
  void help(int most, const std::function<void()>& work) {
    start(most);
    {
      const std::lock_guard lock(mutex_);
      work_ = &work;
      most_ = static_cast<std::size_t>(most);
      ++calls_;
    }
    wake_.notify_all();
    work();
    std::unique_lock lock(mutex_);
    work_ = nullptr;  // nothing is left: other helpers need not begin
    if (at_work_ == 0)
      return;
    lock.unlock();
    holds_soon([this] { return at_work_ == 0; });
    lock.lock();
    idle_.wait(lock, [this] { return at_work_ == 0; });
  }

 private:
  void start(int count) {
    try {
      while (threads_.size() < static_cast<std::size_t>(count))
        threads_.emplace_back([this, index = threads_.size()] { wait_for_work(index); });
    } catch (const std::system_error&) {  // no more threads to be had: fewer do the same
    }
  }

  /// The first ones help wherever few are wanted: else each of them would once get a part that has
  /// parts, and have helpers of its own from then on.
  void wait_for_work(std::size_t index) {
    std::uint64_t seen = 0;
    for (;;) {
      holds_soon([&] { return calls_ != seen; });
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return calls_ != seen; });
      seen = calls_;
      if (is_ending_)
        return;
      if (work_ == nullptr || index >= most_)
        continue;
      ++at_work_;
      const std::function<void()>& work = *work_;
      lock.unlock();
      work();
      lock.lock();
      if (--at_work_ == 0)
        idle_.notify_one();
    }
  }

  std::mutex mutex_;  // guards what follows, but for the threads
  std::condition_variable wake_, idle_;
  const std::function<void()>* work_ = nullptr;
  std::size_t most_ = 0;  // helpers
  bool is_ending_ = false;
  std::atomic<int> at_work_ = 0;          // read also without the mutex
  std::atomic<std::uint64_t> calls_ = 0;  // the same
  std::vector<std::thread> threads_;
};

/// The helpers of this thread, while one of its works needs them. A part of that work that has
/// parts itself has others, which are kept as well.
class OwnHelpers {
 public:
  OwnHelpers() {
    if (levels().size() == depth())
      levels().emplace_back();
    ++depth();
  }
  ~OwnHelpers() { --depth(); }
  OwnHelpers(const OwnHelpers&) = delete;
  OwnHelpers& operator=(const OwnHelpers&) = delete;
  Helpers* operator->() const { return &levels()[depth() - 1]; }

 private:
  static std::deque<Helpers>& levels() {
    thread_local std::deque<Helpers> own;
    return own;
  }
  static std::size_t& depth() {
    thread_local std::size_t own = 0;
    return own;
  }
};

}  // namespace

void for_each_part(int threads, int parts, const std::function<void(int)>& part) {
  std::atomic<int> next = 0;
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(std::max(parts, 0)));
  const std::function<void()> work = [&] {
    for (int i = next++; i < parts; i = next++) {
      try {
        part(i);
      } catch (...) {
        failures[static_cast<std::size_t>(i)] = std::current_exception();
      }
    }
  };
  const int helpers = std::min(threads, parts) - 1;
  if (helpers > 0) {
    const OwnHelpers own;
    own->help(helpers, work);
  } else {
    work();
  }
  for (const std::exception_ptr& failure : failures)
    if (failure)
      std::rethrow_exception(failure);
}

}  // namespace kinship::density
