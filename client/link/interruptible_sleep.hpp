#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace kinship::link {

/// A pause between two requests that another thread can end. May be shared between threads.
class InterruptibleSleep {
 public:
  /// Sleeps, unless end() was called or is called meanwhile.
  /// \return whether the time has passed.
  bool sleep(std::chrono::milliseconds time);

  /// Ends the sleep under way, and later ones at once.
  void end();

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_ended_ = false;  // guarded by mutex_
};

}  // namespace kinship::link
