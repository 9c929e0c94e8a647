#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "client/experiments/pipeline/fleet.hpp"
#include "proto/types/attempt.hpp"

namespace kinship::experiments {

/// How learning sets are recorded.
struct RecordingOptions {
  std::filesystem::path folder;  ///< of learning sets, `<robot>.jsonl` each
  std::uint32_t instances = 0;
  int threads = 1;
  std::function<void()> recorded;  ///< called after each instance, from any thread; may be empty
};

/// What one robot of a study learned: one attempt per learning instance, solved or not, planned
/// uniformly with overshoot 1 and shortened with at most kLearningShortcutChecks.
///
/// Instances that the file has already are taken from it, the others are planned and added line by
/// line. When all are there, the file holds the robot's description and the attempts in order: an
/// experience file that `kinship paths import` reads.
/// \throws Failure(Conflict) that names the file if it holds attempts of something else.
std::vector<Attempt> record_learning_set(const Study& study, const std::vector<StudyMember>& fleet,
                                         std::size_t robot, const RecordingOptions& options);

inline constexpr std::uint64_t kLearningShortcutChecks = 300;

/// The same attempts under another task and with report UUIDs of their own; the first `count`.
std::vector<Attempt> renamed(const std::vector<Attempt>& attempts, const std::string& task,
                             std::size_t count);

}  // namespace kinship::experiments
