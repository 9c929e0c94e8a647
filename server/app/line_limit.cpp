#include "server/app/line_limit.hpp"

#include <utility>

namespace kinship::app {

LineLimit::LineLimit(Sink sink, Options options)
    : sink_(std::move(sink)), options_(std::move(options)), window_start_(options_.now()) {}

void LineLimit::write(std::string_view line) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = options_.now();
  if (now - window_start_ >= options_.window) {
    if (left_out_ > 0)
      sink_(std::to_string(left_out_) + " further lines were left out");
    window_start_ = now;
    lines_ = left_out_ = 0;
  }
  if (lines_ < options_.lines) {
    ++lines_;
    sink_(line);
  } else {
    ++left_out_;
  }
}

}  // namespace kinship::app
