#pragma once

#include <chrono>
#include <map>
#include <string>

namespace kinship::dds {

/// Limits the refusals that a client is sent to ten a second, so that a client with an old
/// certificate, or a ROS node over its quota, cannot cause unlimited work. Not to be shared between
/// threads.
class RefusalRateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// \return whether one more request is answered; the others are dropped.
  bool take(const std::string& client, Clock::time_point now) {
    constexpr std::chrono::seconds kWindow{1};
    constexpr int kAnswered = 10;
    if (now - began_ >= kWindow) {
      answered_.clear();
      began_ = now;
    }
    return ++answered_[client] <= kAnswered;
  }

 private:
  Clock::time_point began_;
  std::map<std::string, int> answered_;  // since then
};

}  // namespace kinship::dds
