#pragma once

#include <string>

#include "server/console/questions.hpp"

/// Figures of the newest attempts, of all tasks and robots.
namespace kinship::console {

/// What the attempts of some time cost, and how many found no path, by task and robot.
/// \param hours  a number.
/// \return {"since_ms", "attempts", "is_whole", "pairs": [{"task", "robot", "attempts", "unsolved",
///         "time_s"}]}; is_whole: all of the time, else the newest kMaxRecentAttempts.
std::string slow_figure(Questions& questions, const std::string& hours);

/// What guidance saves, for each task and robot with guided and control attempts in some time.
/// \param hours  a number.
/// \return {"since_ms", "attempts", "is_whole", "pairs": [{"task", "robot", "guided", "control",
///         "ratio", "low", "high", "saved_s"}]}: the ratio of typical costs uniform / guided with
///         its 90 % interval, null where they cannot be compared; processor time that guided
///         attempts saved against the mean of control ones.
std::string savings_figure(Questions& questions, const std::string& hours);

inline constexpr std::size_t kMaxRecentAttempts = 50'000;

}  // namespace kinship::console
