#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "proto/types/summaries.hpp"

/// Attempts as a server lists them.
namespace kinship::plots::test {

inline constexpr std::int64_t kNoon_ms = 1'763'985'600'000;  // 2025-11-24 12:00 UTC

inline AttemptSummary attempt(std::int64_t received_ms, Outcome outcome, std::uint64_t checks,
                              SamplingMode mode = SamplingMode::Uniform, std::uint8_t robot = 1) {
  AttemptSummary summary;
  summary.robot = Digest{{robot}};
  summary.label = "arm" + std::to_string(robot);
  summary.task = "shelf";
  summary.record.outcome = outcome;
  summary.record.planner = "birrt";
  summary.record.collision_checks = checks;
  summary.record.sampling_mode = mode;
  summary.received_ms = received_ms;
  return summary;
}

/// Guided and control attempts by turns, a second apart.
inline std::vector<AttemptSummary> season(std::size_t pairs, std::uint64_t guided_checks,
                                          std::uint64_t control_checks) {
  std::vector<AttemptSummary> attempts;
  for (std::size_t i = 0; i < pairs; ++i)
    for (const bool is_guided : {true, false})
      attempts.push_back(attempt(kNoon_ms + static_cast<std::int64_t>(attempts.size()) * 1000,
                                 Outcome::Solved,
                                 (is_guided ? guided_checks : control_checks) + i % 7 * 10,
                                 is_guided ? SamplingMode::Guided : SamplingMode::Control));
  return attempts;
}

}  // namespace kinship::plots::test
