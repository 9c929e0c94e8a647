#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/uuid.hpp"

/// The rows that admin verbs list: what the store knows, without waypoints and mixtures.
namespace kinship {

struct RobotSummary {
  Digest robot;
  std::string label;
  std::string base_link, tip_link;
  std::uint32_t dof = 0;
  std::string solver;
  std::uint64_t paths = 0;
  std::uint64_t attempts = 0;
  std::int64_t registered_ms = 0;
};

struct TaskRobotSummary {
  Digest robot;
  std::string label;
  std::uint64_t paths = 0;
  std::uint64_t attempts = 0;
  std::uint64_t generation = 0;
};

struct TaskSummary {
  std::string task;
  std::uint64_t paths = 0;
  std::uint64_t attempts = 0;
  std::vector<TaskRobotSummary> robots;
};

struct PathSummary {
  Uuid report_uuid;
  Digest robot;
  std::string label;
  std::string task;
  std::string machine;
  std::optional<Eigen::Isometry3d> T_task_base;
  PlanningRecord record;
  std::uint64_t waypoints = 0;
  double length = 0;  ///< joint units
  std::int64_t received_ms = 0;
  std::int64_t retired_ms = 0;  ///< 0: in use
};

struct DistributionSummary {
  Digest id;
  std::uint64_t revision = 0;
  std::string task;
  Digest robot;
  std::string label;
  std::string profile;
  DistributionState state = DistributionState::Ready;
  std::string reason;
  std::uint64_t components = 0;
  std::uint64_t configurations = 0;
  std::uint64_t paths = 0;
  std::int64_t fitted_ms = 0;
};

/// What is kept of a distribution, and how it stands to the experience of now.
struct Explanation {
  Distribution distribution;  ///< its mixture may be left out
  struct Now {
    Digest robot;
    std::string label;
    std::uint64_t paths = 0;
    std::uint64_t generation = 0;
  };
  std::vector<Now> experience;  ///< of its task and selection
  bool behind = false;          ///< a fetch would have it fitted again
  std::string next_fit;         ///< when and why it is fitted next, in words
};

/// Paths that were taken out of every fit. They are kept for the record.
struct Retirement {
  std::string task;
  std::uint64_t paths = 0;  ///< retired now; 0: they were retired already
  std::vector<Digest> robots;
};

enum class JobState { Queued, Running, Done, Failed, Cancelled };

/// A long verb on its way, or ended not long ago.
struct Job {
  std::string id;  ///< eight hexadecimal digits
  std::string verb;
  std::string argument;
  JobState state = JobState::Queued;
  double progress = 0;     ///< 0 to 1
  std::string message;     ///< why failed, or what it made
  std::uint64_t rows = 0;  ///< it made, to be read by JobRows
  std::int64_t started_ms = 0;
  std::int64_t ended_ms = 0;  ///< 0: not yet
};

struct ServerStatus {
  std::string version;
  std::string store_file;
  Uuid store_epoch;
  std::uint32_t schema_version = 0;
  std::uint64_t uptime_s = 0;
  std::uint64_t robots = 0, tasks = 0, paths = 0, attempts = 0, distributions = 0;
  std::uint64_t reports_received = 0, reports_refused = 0;       ///< since start
  std::uint64_t fetches = 0, fetches_from_memory = 0, fits = 0;  ///< since start
  std::uint64_t queued_reports = 0, queued_fits = 0;
  std::uint64_t followed = 0;  ///< distributions under a lease
  std::uint64_t jobs = 0;      ///< not ended
  std::uint64_t store_bytes = 0;
  bool writable = true;
  std::string storage_message;  ///< why not writable, or a warning
};

}  // namespace kinship
