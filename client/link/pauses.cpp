#include "client/link/pauses.hpp"

namespace kinship::link {

bool Pauses::sleep(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return !ended_.wait_for(lock, time, [this] { return is_ended_; });
}

void Pauses::end() {
  {
    const std::lock_guard lock(mutex_);
    is_ended_ = true;
  }
  ended_.notify_all();
}

}  // namespace kinship::link
