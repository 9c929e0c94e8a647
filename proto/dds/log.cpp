#include "proto/dds/log.hpp"

#include <dds/ddsrt/log.h>

#include <chrono>
#include <cstdio>
#include <mutex>
#include <utility>

namespace kinship::dds {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kLinesPerWindow = 20;
constexpr std::chrono::seconds kWindow{10};

void write_to_stderr(std::string_view line) {
  std::fprintf(stderr, "cyclonedds: %.*s\n", static_cast<int>(line.size()), line.data());
}

/// The process's log of Cyclone DDS: passes on a limited number of lines per window.
class LimitedLog {
 public:
  void set_sink(LogSink sink) {
    const std::lock_guard lock(mutex_);
    sink_ = std::move(sink);
  }

  std::string last_line() {
    const std::lock_guard lock(mutex_);
    return last_line_;
  }

  void write(std::string_view line) {
    const std::lock_guard lock(mutex_);
    last_line_ = line;
    const Clock::time_point now = Clock::now();
    if (now - window_start_ >= kWindow) {
      if (left_out_ > 0)
        pass_on(std::to_string(left_out_) + " further lines were left out");
      window_start_ = now;
      lines_ = left_out_ = 0;
    }
    if (++lines_ <= kLinesPerWindow)
      pass_on(line);
    else
      ++left_out_;
  }

 private:
  void pass_on(std::string_view line) const {
    if (sink_)
      sink_(line);
  }

  std::mutex mutex_;  // guards everything below
  LogSink sink_ = write_to_stderr;
  std::string last_line_;
  Clock::time_point window_start_ = Clock::now();
  int lines_ = 0;
  int left_out_ = 0;
};

LimitedLog& limited_log() {
  // Never destroyed: threads of Cyclone DDS may write until the process ends.
  static LimitedLog* const log = new LimitedLog;
  return *log;
}

/// Its callers are C and hold locks, which an exception would leave locked for good: without memory
/// a line is lost.
void on_line(void* /*argument*/, const dds_log_data_t* data) noexcept try {
  if (!data)
    return;
  std::string_view line(data->message, data->size);
  while (!line.empty() && line.back() == '\n')
    line.remove_suffix(1);
  limited_log().write(line);
} catch (...) {
}

}  // namespace

void set_log_sink(LogSink sink) { limited_log().set_sink(std::move(sink)); }

void limit_log() { dds_set_log_sink(on_line, nullptr); }

std::string last_log_line() { return limited_log().last_line(); }

}  // namespace kinship::dds
