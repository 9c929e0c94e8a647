#include "client/link/interruptible_sleep.hpp"

namespace kinship::link {

bool InterruptibleSleep::sleep(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return !ended_.wait_for(lock, time, [this] { return is_ended_; });
}

void InterruptibleSleep::end() {
  {
    const std::lock_guard lock(mutex_);
    is_ended_ = true;
  }
  ended_.notify_all();
}

}  // namespace kinship::link
