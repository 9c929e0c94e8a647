#pragma once

#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <mutex>
#include <string>

namespace kinship::experiments {

/// Tells people how far a stage is and when it will be done: a line every few seconds. May be
/// shared between threads.
class RunProgress {
 public:
  /// \param stage  e.g. "planar: learning sets".
  RunProgress(std::ostream& stream, std::string stage, std::size_t total);

  void advance();  ///< one more of the total is done

  /// The last line, with the time the stage took.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void tell(Clock::time_point now);

  std::ostream& stream_;
  const std::string stage_;
  const std::size_t total_;
  const Clock::time_point begin_ = Clock::now();
  std::mutex mutex_;  // guards what follows, and the stream
  std::size_t done_ = 0;
  Clock::time_point told_ = begin_;
};

}  // namespace kinship::experiments
