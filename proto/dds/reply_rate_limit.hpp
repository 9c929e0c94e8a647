#pragma once

#include <chrono>
#include <map>
#include <string>

namespace kinship::dds {

/// Limits the replies that a client is sent in a second. Not to be shared between threads.
class ReplyRateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ReplyRateLimit(int replies_per_s) : replies_per_s_(replies_per_s) {}

  /// \return whether one more request is answered; the others are dropped.
  bool take(const std::string& client, Clock::time_point now) {
    constexpr std::chrono::seconds kWindow{1};
    if (now - began_ >= kWindow) {
      answered_.clear();
      began_ = now;
    }
    return ++answered_[client] <= replies_per_s_;
  }

 private:
  int replies_per_s_;
  Clock::time_point began_;
  std::map<std::string, int> answered_;  // since then
};

}  // namespace kinship::dds
