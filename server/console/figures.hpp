#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "server/console/questions.hpp"

namespace kinship::console {

/// Makes what pages draw. Figures of recent attempts, which open pages ask for again and again, are
/// kept for a hundred times as long as they took: whatever number of pages asks, they take a
/// hundredth of a core. To be used by one thread.
class Figures {
 public:
  using Clock = std::chrono::steady_clock;

  /// \param questions  outlives the figures; answers while one is made.
  /// \param now        of the clock by which figures are kept.
  explicit Figures(Questions& questions, std::function<Clock::time_point()> now = &Clock::now)
      : questions_(questions), now_(std::move(now)) {}

  static bool has_kind(std::string_view kind);

  /// \param kind  has_kind()
  /// \param name  of the robot, task, distribution, path or attempt; hours of recent attempts
  /// \return JSON. \throws Failure if there is none.
  const std::string& make(const std::string& kind, const std::string& name);

 private:
  struct Kept {
    std::string text;
    Clock::time_point until;
  };

  Questions& questions_;
  const std::function<Clock::time_point()> now_;
  std::string text_;  // the last one
  std::map<std::pair<std::string, std::string>, Kept> kept_;
};

}  // namespace kinship::console
