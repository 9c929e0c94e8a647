#pragma once

#include <cstdint>
#include <vector>

#include "proto/types/advice.hpp"

namespace kinship::evidence {

/// The newest judged attempts of a (task, robot), oldest first, at most kJudgedAttemptsPerMode of
/// each sampling mode. The server fills it with the attempts of all machines, a client continues it
/// with its own.
class AttemptWindow {
 public:
  AttemptWindow() = default;
  /// \param recent  oldest first, as in an Advice; the oldest beyond the window are dropped.
  explicit AttemptWindow(std::vector<JudgedAttempt> recent);

  /// An attempt newer than all others, which age by one. Uniform ones are no evidence: ignored.
  /// \param time_s  see JudgedAttempt; 0: unknown.
  void add(SamplingMode mode, bool solved, std::uint64_t checks, double time_s = 0);

  const std::vector<JudgedAttempt>& recent() const noexcept { return recent_; }

 private:
  void drop_beyond_window(SamplingMode mode);

  std::vector<JudgedAttempt> recent_;
};

}  // namespace kinship::evidence
