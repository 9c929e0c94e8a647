#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/field.hpp"

namespace kinship {

/// Cost of all attempts of a (task, robot) in one sampling mode. An unsolved attempt is censored:
/// its checks count, it adds no solution.
struct ModeEvidence {
  std::uint64_t attempts = 0;
  std::uint64_t solved = 0;
  double checks_per_solution = 0;  ///< all checks in the mode / solved; 0 if none was solved

  bool operator==(const ModeEvidence&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<ModeEvidence>{
    Field{"attempts", &ModeEvidence::attempts}, Field{"solved", &ModeEvidence::solved},
    Field{"checks_per_solution", &ModeEvidence::checks_per_solution, {.min = 0}}};

/// Means over the solved attempts of a sampling mode of which time and path were measured.
struct PathMeans {
  std::uint64_t attempts = 0;
  double time_s = 0;  ///< processor time of everything, on a machine of speed 1 (PlanningRecord)
  double length = 0;  ///< joint units
  double hand_length_m = 0, least_clearance_m = 0;
};

template <>
inline constexpr std::tuple kFieldsOf<PathMeans>{
    Field{"attempts", &PathMeans::attempts}, Field{"time_s", &PathMeans::time_s, {.min = 0}},
    Field{"length", &PathMeans::length, {.min = 0}},
    Field{"hand_length_m", &PathMeans::hand_length_m, {.min = 0}},
    Field{"least_clearance_m", &PathMeans::least_clearance_m, {.min = 0}}};

inline constexpr std::size_t kJudgedAttemptsPerMode =
    128;  ///< the newest ones; older are forgotten

/// One attempt of a (task, robot) from which the worth of guidance is judged: guided, or uniform
/// although guidance was there (control). One that could not be planned at all (start in collision,
/// no goal: Outcome::Failed) says nothing about samples and is not judged.
struct JudgedAttempt {
  SamplingMode sampling_mode = SamplingMode::Guided;  ///< Guided or Control
  bool solved = false;
  std::uint64_t checks = 0;  ///< collision checks
  std::uint32_t age = 0;     ///< judged attempts in either mode that came after it
  /// Processor time of everything, on a machine of speed 1 (PlanningRecord: time x speed), s; 0:
  /// unknown.
  double time_s = 0;

  bool operator==(const JudgedAttempt&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<JudgedAttempt>{
    Field{"sampling_mode",
          &JudgedAttempt::sampling_mode,
          {.max = static_cast<double>(SamplingMode::Control)}},
    Field{"solved", &JudgedAttempt::solved}, Field{"checks", &JudgedAttempt::checks},
    Field{"age", &JudgedAttempt::age},
    Field{"time_s", &JudgedAttempt::time_s, {.min = 0, .may_be_missing = true}}};

/// Advice on guidance from the attempts of a (task, robot) on all machines.
struct Advice {
  /// Share of guided samples for clients that plan every query alike, 0 to 1; falls as guidance
  /// proves worse.
  double recommended_share = 0;
  /// Share of guided samples in a guided query, for clients that choose a sampling mode per query,
  /// 0 to 1.
  double guided_share = 0;
  std::string evidence;                         ///< for recommended_share, as text
  std::optional<ModeEvidence> guided, control;  ///< missing: no such attempts
  std::vector<JudgedAttempt> recent;            ///< the newest in each mode, oldest first
};

}  // namespace kinship
