#include "proto/evidence/attempt_window.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kinship::evidence {

AttemptWindow::AttemptWindow(std::vector<JudgedAttempt> recent) : recent_(std::move(recent)) {
  std::erase_if(recent_, [](const JudgedAttempt& one) { return one.arm == Arm::Uniform; });
  for (const Arm arm : {Arm::Guided, Arm::Control})
    drop_beyond_window(arm);
}

void AttemptWindow::add(Arm arm, bool solved, std::uint64_t checks) {
  if (arm == Arm::Uniform)
    return;
  for (JudgedAttempt& one : recent_)
    if (one.age < std::numeric_limits<std::uint32_t>::max())
      ++one.age;
  recent_.push_back({.arm = arm, .solved = solved, .checks = checks, .age = 0});
  drop_beyond_window(arm);
}

void AttemptWindow::drop_beyond_window(Arm arm) {
  const auto is_of_arm = [arm](const JudgedAttempt& one) { return one.arm == arm; };
  auto count = static_cast<std::size_t>(std::count_if(recent_.begin(), recent_.end(), is_of_arm));
  std::erase_if(recent_, [&](const JudgedAttempt& one) {
    return is_of_arm(one) && count > kJudgedAttemptsPerArm && count-- > 0;
  });
}

}  // namespace kinship::evidence
