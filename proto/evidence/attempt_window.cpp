#include "proto/evidence/attempt_window.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kinship::evidence {

AttemptWindow::AttemptWindow(std::vector<JudgedAttempt> recent) : recent_(std::move(recent)) {
  std::erase_if(
      recent_, [](const JudgedAttempt& one) { return one.sampling_mode == SamplingMode::Uniform; });
  for (const SamplingMode mode : {SamplingMode::Guided, SamplingMode::Control})
    drop_beyond_window(mode);
}

void AttemptWindow::add(SamplingMode mode, bool solved, std::uint64_t checks, double time_s) {
  if (mode == SamplingMode::Uniform)
    return;
  for (JudgedAttempt& one : recent_)
    if (one.age < std::numeric_limits<std::uint32_t>::max())
      ++one.age;
  recent_.push_back(
      {.sampling_mode = mode, .solved = solved, .checks = checks, .age = 0, .time_s = time_s});
  drop_beyond_window(mode);
}

void AttemptWindow::drop_beyond_window(SamplingMode mode) {
  const auto is_of_mode = [mode](const JudgedAttempt& one) { return one.sampling_mode == mode; };
  auto count = static_cast<std::size_t>(std::count_if(recent_.begin(), recent_.end(), is_of_mode));
  std::erase_if(recent_, [&](const JudgedAttempt& one) {
    return is_of_mode(one) && count > kJudgedAttemptsPerMode && count-- > 0;
  });
}

}  // namespace kinship::evidence
