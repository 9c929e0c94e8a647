#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace kinship::link {

/// Pauses between two requests, which another thread can end. May be shared between threads.
class Pauses {
 public:
  /// Sleeps, unless end() was called or is called meanwhile.
  /// \return whether the time has passed.
  bool sleep(std::chrono::milliseconds time);

  /// Ends the pauses under way, and later ones at once.
  void end();

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_ended_ = false;  // guarded by mutex_
};

}  // namespace kinship::link
