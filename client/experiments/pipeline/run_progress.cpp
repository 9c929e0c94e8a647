#include "client/experiments/pipeline/run_progress.hpp"

#include <cstdio>
#include <ostream>
#include <utility>

namespace kinship::experiments {
namespace {

constexpr std::chrono::seconds kInterval{5};

std::string duration_text(double seconds) {
  constexpr double kMinute = 60;
  char text[32];
  if (seconds < 2 * kMinute)
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  else
    std::snprintf(text, sizeof text, "%.0f min", seconds / kMinute);
  return text;
}

}  // namespace

RunProgress::RunProgress(std::ostream& stream, std::string stage, std::size_t total)
    : stream_(stream), stage_(std::move(stage)), total_(total) {}

void RunProgress::advance() {
  const std::lock_guard lock(mutex_);
  ++done_;
  const Clock::time_point now = Clock::now();
  if (now - told_ >= kInterval)
    tell(now);
}

void RunProgress::tell(Clock::time_point now) {
  told_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  const double left_s =
      elapsed_s * static_cast<double>(total_ - done_) / static_cast<double>(done_);
  stream_ << stage_ << ": " << done_ << " of " << total_ << ", " << duration_text(left_s)
          << " to go" << std::endl;
}

void RunProgress::finish() {
  const std::lock_guard lock(mutex_);
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin_).count();
  stream_ << stage_ << ": " << done_ << " of " << total_ << " in " << duration_text(elapsed_s)
          << std::endl;
}

}  // namespace kinship::experiments
