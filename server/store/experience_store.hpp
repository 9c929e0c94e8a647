#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/attempt_filter.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/page.hpp"

namespace kinship::store {

/// A path with the data that a transfer needs.
struct StoredPath {
  std::int64_t id = 0;  ///< grows with arrival
  Uuid report_uuid;
  std::optional<Eigen::Isometry3d> T_task_base;
  std::int64_t received_ms = 0;
  Path path;
  std::optional<std::int64_t> scene_id = {};  ///< of the scene it was planned in, for read_scene()
};

/// Which paths of a robot and task are read: a page of them, in the order of arrival.
struct PathRange {
  std::int64_t after_id = 0;  ///< ids greater than this
  std::size_t limit = 0;
  std::int64_t since_ms = 0;  ///< received at or after; 0: all
  /// State of the experience: this generation of the robot and task or a later one, never one older
  /// than the last reading; 0: the current one.
  std::uint64_t generation = 0;
};

/// One (robot, task) pair that has, or had, paths.
struct ExperienceSummary {
  Digest robot;
  std::uint64_t paths = 0;  ///< without retired, dropped and damaged ones
  std::uint64_t generation = 0;
  std::uint64_t retired_generation = 0;  ///< when a path was retired last; 0: never
  std::uint64_t dropped = 0;             ///< paths beyond the cap, in total
};

/// Sums over the attempts in one sampling mode, from which the interval of a ratio follows.
struct ModeTotals {
  std::uint64_t attempts = 0;
  std::uint64_t solved = 0;
  double checks = 0;            ///< collision checks, of solved and unsolved ones
  double checks_squared = 0;    ///< sum of their squares
  double checks_of_solved = 0;  ///< of the solved ones alone
  /// Solved ones of which time and path were measured, and their sums (see PathMeans).
  std::uint64_t measured = 0;
  double time_s = 0, length = 0, hand_length_m = 0, clearance_m = 0;
};

/// A judged attempt with its planner and distribution.
struct KnownAttempt {
  JudgedAttempt judged;
  std::string planner = {};
  std::optional<Digest> distribution_id = {};  ///< missing: the client did not say

  bool operator==(const KnownAttempt&) const = default;
};

/// Attempts of each sampling mode that are known, of all planners; more than are judged, which are
/// of one planner.
inline constexpr std::size_t kKnownAttemptsPerMode = 2 * kJudgedAttemptsPerMode;

/// The attempts of one robot and task, by sampling mode.
struct AttemptTotals {
  ModeTotals guided, control;
  std::vector<KnownAttempt> recent;  ///< the newest kKnownAttemptsPerMode of each, oldest first
};

/// The attempts of a listing.
struct WantedAttempts {
  std::optional<Digest> robot = {};  ///< missing: all
  std::string_view task = {};        ///< empty: all
  AttemptFilter filter = {};
};

/// Names of tasks as long as another name, but for some letters.
struct WantedNames {
  std::string_view like = {};
  std::size_t letters = 0;
  bool with_paths = false;
  std::size_t limit = 0;
};

/// Reads attempts, paths and scenes, by robot and task; see Store.
class ExperienceStore {
 public:
  /// Names the store's history: changes when the store is restored, or turns out to be a copy or
  /// rolled back.
  virtual Uuid epoch() const = 0;

  /// The robots that have, or had, paths of a task, by digest.
  virtual std::vector<ExperienceSummary> experience(std::string_view task) const = 0;
  virtual std::uint64_t generation(const Digest& robot, std::string_view task) const = 0;
  /// Paths of one robot and task in order of ids, without retired and dropped ones. A path whose
  /// blob fails its CRC is quarantined (kept, marked damaged, counted in the status) and left out.
  virtual std::vector<StoredPath> read_paths(const Digest& robot, std::string_view task,
                                             const PathRange& range) const = 0;
  /// The ids of these paths, ascending, without reading the paths.
  /// \param generation  see PathRange.
  virtual std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                             std::uint64_t generation = 0) const = 0;
  /// The scene of a path: equal ids, equal scenes. Nothing if it is missing or damaged; one whose
  /// blob fails its CRC is quarantined (kept, marked damaged, counted in the status) until a report
  /// brings it again; its paths are still read.
  virtual std::optional<RecordedScene> read_scene(std::int64_t scene_id) const = 0;
  virtual AttemptTotals attempt_totals(const Digest& robot, std::string_view task) const = 0;

  virtual Page<TaskSummary> list_tasks(std::string_view cursor, std::size_t limit) const = 0;
  virtual std::optional<TaskSummary> find_task(std::string_view task) const = 0;
  /// In order, of listed tasks.
  virtual std::vector<std::string> task_names(const WantedNames& wanted) const = 0;
  /// The newest first, retired and dropped ones too. Empty robot or task: all.
  virtual Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                                       std::string_view cursor, std::size_t limit) const = 0;
  /// In order of arrival, unsolved ones and those of retired paths too. Empty robot or task: all.
  virtual Page<AttemptSummary> list_attempts(const std::optional<Digest>& robot,
                                             std::string_view task, std::string_view cursor,
                                             std::size_t limit) const = 0;
  /// The newest, or slowest, first, with what their search records say. A page looks at the newest
  /// kMaxSlowestOf attempts of the robot and task from its cursor on, so it may be short before the
  /// last one; of the slowest there is one page.
  virtual Page<AttemptSummary> find_attempts(const WantedAttempts& wanted, std::string_view cursor,
                                             std::size_t limit) const = 0;
  /// An attempt with its path, scene and search record, by report UUID; unsolved ones too. Without
  /// its path if that is damaged or dropped, without its scene or search record if that is damaged
  /// or was let go.
  virtual std::optional<Attempt> find_attempt(const Uuid& report_uuid) const = 0;
  /// Reports of attempts from one UUID to another, both included, in order; at most `limit`.
  virtual std::vector<Uuid> reports_between(const Uuid& first, const Uuid& last,
                                            std::size_t limit) const = 0;
  /// Attempts with their paths and scenes for export, oldest first; without the attempts of
  /// retired, dropped and damaged paths. A page ends early once its waypoints and scenes (as
  /// scene_bytes() counts) exceed `max_bytes`, but has at least one.
  virtual Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                        std::string_view cursor, std::size_t limit,
                                        std::size_t max_bytes) const = 0;

 protected:
  ~ExperienceStore() = default;
};

}  // namespace kinship::store
