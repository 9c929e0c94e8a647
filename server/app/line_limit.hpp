#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace kinship::app {

/// Passes on a limited number of lines per window of time, then one with the number of lines left
/// out: requests of one client must not fill the disk with lines. May be shared between threads.
class LineLimit {
 public:
  using Clock = std::chrono::steady_clock;
  using Sink = std::function<void(std::string_view line)>;
  using Now = std::function<Clock::time_point()>;

  struct Options {
    int lines = 100;
    std::chrono::seconds window{10};
    Now now = Clock::now;
  };

  /// \param sink  called by write(), one call at a time.
  LineLimit(Sink sink, Options options);

  void write(std::string_view line);

 private:
  const Sink sink_;
  const Options options_;
  std::mutex mutex_;  // guards what follows
  Clock::time_point window_start_;
  int lines_ = 0;
  int left_out_ = 0;
};

}  // namespace kinship::app
