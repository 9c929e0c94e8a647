#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/path.hpp"
#include "proto/types/recorded_scene.hpp"
#include "proto/types/search_record.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

enum class Outcome { Solved, Timeout, Failed };

/// Source of a path.
enum class FoundBy {
  Nothing,       ///< no path, or source unknown
  StraightLine,  ///< before any sample
  Track,         ///< a stored pose path, moved onto the query
  Search,        ///< samples
  Recalled       ///< a stored path, moved onto the query whole, before any sample
};

/// How the samples of an attempt were chosen: by guidance, uniformly on purpose to compare
/// (control), or uniformly because there was no guidance.
enum class SamplingMode { Guided, Control, Uniform };

/// A planner's record of one query. One collision check = one configuration tested for any kind of
/// collision.
struct PlanningRecord {
  Outcome outcome = Outcome::Failed;
  std::string planner;
  std::string planner_options;  ///< free text, e.g. "step=0.1 shortcut_checks=300"
  double planning_time_s = 0;
  std::uint64_t collision_checks = 0;
  std::uint64_t projections = 0;
  double time_limit_s = 0;
  SamplingMode sampling_mode = SamplingMode::Uniform;
  double share = 0;  ///< of samples drawn from the distribution, 0 to 1
  std::optional<Digest> distribution_id;
  std::uint64_t distribution_revision = 0;
  /// Processor time of the query with everything that guidance costs: start, goals, samples,
  /// search, shortening, proof; 0: unknown.
  double processor_time_s = 0;
  /// Of the machine that planned, as evidence::machine_speed() measures it; 0: unknown.
  double machine_speed = 0;
  /// Of the solution: way of the transfer frame, and least clearance from obstacles (at most 0.1 m
  /// is looked for); 0: not measured.
  double hand_length_m = 0, least_clearance_m = 0;
};

template <>
inline constexpr std::tuple kFieldsOf<PlanningRecord>{
    Field{"outcome", &PlanningRecord::outcome},
    Field{"planner",
          &PlanningRecord::planner,
          {.limit = kMaxPlannerBytes, .check = check_planner, .may_be_missing = true}},
    Field{"planner_options",
          &PlanningRecord::planner_options,
          {.limit = kMaxPlannerOptionsBytes, .may_be_missing = true}},
    Field{"planning_time_s", &PlanningRecord::planning_time_s, {.min = 0}},
    Field{"collision_checks", &PlanningRecord::collision_checks},
    Field{"projections", &PlanningRecord::projections, {.may_be_missing = true}},
    Field{"time_limit_s", &PlanningRecord::time_limit_s, {.min = 0, .may_be_missing = true}},
    Field{"sampling_mode", &PlanningRecord::sampling_mode, {.may_be_missing = true}},
    Field{"share", &PlanningRecord::share, {.min = 0, .max = 1, .may_be_missing = true}},
    Field{"distribution_id", &PlanningRecord::distribution_id},
    Field{
        "distribution_revision", &PlanningRecord::distribution_revision, {.may_be_missing = true}},
    Field{"processor_time_s",
          &PlanningRecord::processor_time_s,
          {.min = 0, .max = 1e9, .may_be_missing = true, .mark = "processor_time_s"}},
    Field{"machine_speed",
          &PlanningRecord::machine_speed,
          {.min = 0, .max = 1e6, .may_be_missing = true, .mark = "machine_speed"}},
    Field{"hand_length_m",
          &PlanningRecord::hand_length_m,
          {.min = 0, .max = 1e9, .may_be_missing = true, .mark = "hand_length_m"}},
    Field{"least_clearance_m",
          &PlanningRecord::least_clearance_m,
          {.min = 0, .max = 1e9, .may_be_missing = true, .mark = "least_clearance_m"}}};

/// One planning query of a client: solved (with a path) or not (without).
struct Attempt {
  Uuid report_uuid;
  Digest robot;
  std::string machine;
  std::string task;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< missing: used as identity, stored as missing
  PlanningRecord record;
  std::optional<Path> path;            ///< present exactly if solved
  std::optional<RecordedScene> scene;  ///< optional
  std::optional<SearchRecord> search;  ///< optional; no part of what makes a report a duplicate
};

/// The rule of the contract that an attempt breaks, if any. Attempts are checked where they enter a
/// program: by Client::report() and deliver(), by the readers of files and messages, and by a store
/// that takes them from another store. The server checks that the robot is known and the path
/// within its limits.
std::optional<Error> validate(const Attempt& attempt);

/// Bytes of attempts that count against the limits of a batch.
struct BatchBytes {
  std::size_t waypoints = 0;  ///< 8 per waypoint and joint; with searches at most kMaxBatchBytes
  std::size_t scenes = 0;     ///< as scene_bytes() counts; at most kMaxSceneBytes
  std::size_t searches = 0;   ///< as search_bytes() counts

  bool fits() const noexcept {
    return waypoints + searches <= kMaxBatchBytes && scenes <= kMaxSceneBytes;
  }

  friend BatchBytes operator+(const BatchBytes& a, const BatchBytes& b) noexcept {
    return {a.waypoints + b.waypoints, a.scenes + b.scenes, a.searches + b.searches};
  }
};

BatchBytes batch_bytes(const Attempt& attempt);

}  // namespace kinship
