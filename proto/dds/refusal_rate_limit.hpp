#pragma once

#include <chrono>
#include <map>
#include <string>

namespace kinship::dds {

/// How many requests of a client that may not ask at all are answered: ten a second, so that who
/// has a certificate of old cannot have the server work as much as it likes. Not to be shared
/// between threads.
class RefusalRateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// \return whether one more is answered; the rest of them is dropped.
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
