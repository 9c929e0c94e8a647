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

/// What all attempts in one sampling mode of a (task, robot) cost. An attempt that did not solve
/// its problem is censored: its checks count, it adds no solution.
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

inline constexpr std::size_t kJudgedAttemptsPerMode =
    128;  ///< the newest ones; older are forgotten

/// One attempt of a (task, robot) from which the worth of guidance is judged: guided, or uniform
/// although guidance was there (control). One that could not be planned at all (start in collision,
/// no goal: Outcome::Failed) says nothing about samples and is none.
struct JudgedAttempt {
  SamplingMode sampling_mode = SamplingMode::Guided;  ///< Guided or Control
  bool solved = false;
  std::uint64_t checks = 0;  ///< collision checks
  std::uint32_t age = 0;     ///< judged attempts in either mode that came after it

  bool operator==(const JudgedAttempt&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<JudgedAttempt>{
    Field{"sampling_mode",
          &JudgedAttempt::sampling_mode,
          {.max = static_cast<double>(SamplingMode::Control)}},
    Field{"solved", &JudgedAttempt::solved}, Field{"checks", &JudgedAttempt::checks},
    Field{"age", &JudgedAttempt::age}};

/// What the attempts of a (task, robot) say about guidance, on whichever machines they were made.
struct Advice {
  /// For clients that plan every query alike: of guided samples, 0 to 1; falls as guidance turns
  /// out worse.
  double recommended_share = 0;
  /// For clients that choose a sampling mode per query: of guided samples in a guided query, 0
  /// to 1.
  double guided_share = 0;
  std::string evidence;                         ///< for recommended_share, in words
  std::optional<ModeEvidence> guided, control;  ///< missing: no such attempts
  std::vector<JudgedAttempt> recent;            ///< the newest in each mode, oldest first
};

}  // namespace kinship
