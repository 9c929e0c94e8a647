#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "proto/types/advice.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/audit.hpp"
#include "proto/types/backup_summary.hpp"
#include "proto/types/client_use.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/removals.hpp"
#include "proto/types/selection.hpp"
#include "proto/types/uuid.hpp"

/// The rows of admin verbs: contents of the store, without waypoints and mixtures.
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
  std::string geometry = {};     ///< description of its shapes
  std::int64_t geometry_ms = 0;  ///< when better geometry was last taken over; 0: never
  std::string meshes = {};       ///< what of its meshes is here and what is missing; may be empty
};

template <>
inline constexpr std::tuple kFieldsOf<RobotSummary>{
    Field{"robot", &RobotSummary::robot},
    Field{"label", &RobotSummary::label, {.limit = kMaxLabelBytes}},
    Field{"base_link", &RobotSummary::base_link, {.limit = kMaxLinkNameBytes}},
    Field{"tip_link", &RobotSummary::tip_link, {.limit = kMaxLinkNameBytes}},
    Field{"dof", &RobotSummary::dof},
    Field{"solver", &RobotSummary::solver, {.limit = kMaxMessageBytes}},
    Field{"paths", &RobotSummary::paths},
    Field{"attempts", &RobotSummary::attempts},
    Field{"registered_ms", &RobotSummary::registered_ms},
    Field{"geometry", &RobotSummary::geometry, {.limit = kMaxMessageBytes, .may_be_missing = true}},
    Field{"geometry_ms", &RobotSummary::geometry_ms, {.may_be_missing = true}},
    Field{"meshes", &RobotSummary::meshes, {.limit = kMaxMessageBytes, .may_be_missing = true}}};

/// The content of a mesh, as a server keeps it.
struct StoredMesh {
  Digest content;
  std::uint64_t bytes = 0;  ///< before compression
  std::string zlib;         ///< in base64
};

template <>
inline constexpr std::tuple kFieldsOf<StoredMesh>{
    Field{"content", &StoredMesh::content},
    Field{"bytes", &StoredMesh::bytes, between(0, kMaxCanonicalMeshBytes)},
    Field{"zlib", &StoredMesh::zlib, {.limit = kMaxMeshZlibBytes / 3 * 4 + 4}}};

struct TaskRobotSummary {
  Digest robot;
  std::string label;
  std::uint64_t paths = 0;
  std::uint64_t attempts = 0;
  std::uint64_t generation = 0;
  std::uint64_t dropped = 0;  ///< paths beyond the cap
  /// Costs of all guided and control attempts; missing: none, or an older server.
  std::optional<ModeEvidence> guided = {}, control = {};
  std::optional<PathMeans> guided_means = {}, control_means = {};  ///< missing: none
};

template <>
inline constexpr std::tuple kFieldsOf<TaskRobotSummary>{
    Field{"robot", &TaskRobotSummary::robot},
    Field{"label", &TaskRobotSummary::label, {.limit = kMaxLabelBytes}},
    Field{"paths", &TaskRobotSummary::paths},
    Field{"attempts", &TaskRobotSummary::attempts},
    Field{"generation", &TaskRobotSummary::generation},
    Field{"dropped", &TaskRobotSummary::dropped, {.may_be_missing = true}},
    Field{"guided", &TaskRobotSummary::guided},
    Field{"control", &TaskRobotSummary::control},
    Field{"guided_means", &TaskRobotSummary::guided_means, {.may_be_missing = true}},
    Field{"control_means", &TaskRobotSummary::control_means, {.may_be_missing = true}}};

struct TaskSummary {
  std::string task;
  std::uint64_t paths = 0;
  std::uint64_t attempts = 0;
  std::vector<TaskRobotSummary> robots;
  std::uint64_t dropped = 0;  ///< paths beyond the cap of a robot and task
};

template <>
inline constexpr std::tuple kFieldsOf<TaskSummary>{
    Field{"task", &TaskSummary::task, {.limit = kMaxTaskBytes}},
    Field{"paths", &TaskSummary::paths}, Field{"attempts", &TaskSummary::attempts},
    Field{"robots", &TaskSummary::robots, {.limit = kMaxSources}},
    Field{"dropped", &TaskSummary::dropped, {.may_be_missing = true}}};

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
  bool dropped = false;         ///< retired because it was beyond the cap; its waypoints are gone
};

template <>
inline constexpr std::tuple kFieldsOf<PathSummary>{
    Field{"report_uuid", &PathSummary::report_uuid},
    Field{"robot", &PathSummary::robot},
    Field{"label", &PathSummary::label, {.limit = kMaxLabelBytes}},
    Field{"task", &PathSummary::task, {.limit = kMaxTaskBytes}},
    Field{"machine", &PathSummary::machine, {.limit = kMaxMachineBytes}},
    Field{"T_task_base", &PathSummary::T_task_base},
    Field{"record", &PathSummary::record},
    Field{"waypoints", &PathSummary::waypoints},
    Field{"length", &PathSummary::length, {.min = 0}},
    Field{"received_ms", &PathSummary::received_ms},
    Field{"retired_ms", &PathSummary::retired_ms},
    Field{"dropped", &PathSummary::dropped, {.may_be_missing = true}}};

/// A reported attempt, solved or not, without its query and path.
struct AttemptSummary {
  Uuid report_uuid;
  Digest robot;
  std::string label;
  std::string task;
  std::string machine;
  PlanningRecord record;
  std::int64_t received_ms = 0;
  /// Whether the store has its search record, and the why_text() of that; of FindAttempts alone.
  bool has_search = false;
  std::string why = {};
  double length = 0;  ///< of its path, joint units; 0: none, or not by FindAttempts
};

template <>
inline constexpr std::tuple kFieldsOf<AttemptSummary>{
    Field{"report_uuid", &AttemptSummary::report_uuid},
    Field{"robot", &AttemptSummary::robot},
    Field{"label", &AttemptSummary::label, {.limit = kMaxLabelBytes}},
    Field{"task", &AttemptSummary::task, {.limit = kMaxTaskBytes}},
    Field{"machine", &AttemptSummary::machine, {.limit = kMaxMachineBytes}},
    Field{"record", &AttemptSummary::record},
    Field{"received_ms", &AttemptSummary::received_ms},
    Field{"has_search", &AttemptSummary::has_search, {.may_be_missing = true}},
    Field{"why", &AttemptSummary::why, {.limit = kMaxWhyBytes, .may_be_missing = true}},
    Field{"length", &AttemptSummary::length, {.min = 0, .may_be_missing = true}}};

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
  bool retired = false;  ///< made of paths that were retired since: it is not served any more
  std::optional<Eigen::Isometry3d> T_task_base = {};  ///< snapped; missing also from older servers
  Selection selection = {};                           ///< as in Distribution
};

template <>
inline constexpr std::tuple kFieldsOf<DistributionSummary>{
    Field{"id", &DistributionSummary::id},
    Field{"revision", &DistributionSummary::revision},
    Field{"task", &DistributionSummary::task, {.limit = kMaxTaskBytes}},
    Field{"robot", &DistributionSummary::robot},
    Field{"label", &DistributionSummary::label, {.limit = kMaxLabelBytes}},
    Field{"profile", &DistributionSummary::profile, {.limit = kMaxProfileBytes}},
    Field{"state", &DistributionSummary::state},
    Field{"reason", &DistributionSummary::reason, {.limit = kMaxMessageBytes}},
    Field{"components", &DistributionSummary::components},
    Field{"configurations", &DistributionSummary::configurations},
    Field{"paths", &DistributionSummary::paths},
    Field{"fitted_ms", &DistributionSummary::fitted_ms},
    Field{"retired", &DistributionSummary::retired, {.may_be_missing = true}},
    Field{"T_task_base", &DistributionSummary::T_task_base},
    Field{"selection", &DistributionSummary::selection, {.may_be_missing = true}}};

/// A distribution compared with the current experience.
struct Explanation {
  Distribution distribution;  ///< its mixture may be left out
  struct Now {
    Digest robot;
    std::string label;
    std::uint64_t paths = 0;
    std::uint64_t generation = 0;
  };
  std::vector<Now> experience;              ///< of its task and selection
  bool behind = false;                      ///< a fetch would refit it
  std::string next_fit;                     ///< when and why it is fitted next, as text
  std::optional<Rehearsal> rehearsal = {};  ///< of its robot and task; missing: not yet
};

template <>
inline constexpr std::tuple kFieldsOf<Explanation::Now>{
    Field{"robot", &Explanation::Now::robot},
    Field{"label", &Explanation::Now::label, {.limit = kMaxLabelBytes}},
    Field{"paths", &Explanation::Now::paths}, Field{"generation", &Explanation::Now::generation}};

enum class JobState { Queued, Running, Done, Failed, Cancelled };

/// A long verb that waits, runs or ended recently.
struct Job {
  std::string id;  ///< eight hexadecimal digits
  std::string verb;
  std::string argument;
  JobState state = JobState::Queued;
  double progress = 0;     ///< 0 to 1
  std::string message;     ///< why it failed, or its result
  std::uint64_t rows = 0;  ///< made by the job, to read with JobRows
  std::int64_t started_ms = 0;
  std::int64_t ended_ms = 0;  ///< 0: not yet
};

template <>
inline constexpr std::tuple kFieldsOf<Job>{
    Field{"id", &Job::id, {.limit = kMaxWordBytes}},
    Field{"verb", &Job::verb, {.limit = kMaxWordBytes}},
    Field{"argument", &Job::argument, {.limit = kMaxTargetBytes}},
    Field{"state", &Job::state},
    Field{"progress", &Job::progress, {.min = 0, .max = 1}},
    Field{"message", &Job::message, {.limit = kMaxMessageBytes}},
    Field{"rows", &Job::rows},
    Field{"started_ms", &Job::started_ms},
    Field{"ended_ms", &Job::ended_ms}};

/// Number of errors of one kind for clients since start.
struct TroubleCount {
  std::string what;
  std::uint64_t count = 0;
  std::string last;  ///< text of the last one
  std::int64_t last_ms = 0;
};

template <>
inline constexpr std::tuple kFieldsOf<TroubleCount>{
    Field{"what", &TroubleCount::what, {.limit = kMaxWordBytes}},
    Field{"count", &TroubleCount::count},
    Field{"last", &TroubleCount::last, {.limit = kMaxMessageBytes}},
    Field{"last_ms", &TroubleCount::last_ms}};

/// Use of a bounded resource.
struct BoundUse {
  std::string what;
  std::uint64_t used = 0;
  std::uint64_t limit = 0;
};

template <>
inline constexpr std::tuple kFieldsOf<BoundUse>{
    Field{"what", &BoundUse::what, {.limit = kMaxWordBytes}}, Field{"used", &BoundUse::used},
    Field{"limit", &BoundUse::limit}};

/// A host of the store's database that fits read while it is a standby and new enough; else they
/// read the primary. Since start.
struct ReplicaUse {
  std::string host;
  std::uint64_t readings = 0;  ///< that it answered
  std::uint64_t behind = 0;    ///< that needed newer data than it had
  std::uint64_t failed = 0;    ///< that it did not answer, or ended
  std::string message;         ///< why it is not used now; empty: it is
};

template <>
inline constexpr std::tuple kFieldsOf<ReplicaUse>{
    Field{"host", &ReplicaUse::host, {.limit = kMaxMessageBytes}},
    Field{"readings", &ReplicaUse::readings}, Field{"behind", &ReplicaUse::behind},
    Field{"failed", &ReplicaUse::failed},
    Field{"message", &ReplicaUse::message, {.limit = kMaxPageBytes}}};

/// State of the exchange of a site with the memory above it (kinshipd --upstream).
struct UpstreamStatus {
  std::string name;
  bool connected = false;
  std::int64_t since_ms = 0;           ///< Unix time: connected, or disconnected
  std::string message;                 ///< why disconnected
  std::uint64_t tries = 0;             ///< failed attempts to connect since then
  std::uint64_t waiting = 0;           ///< reports not yet checked with the memory
  std::int64_t oldest_waiting_ms = 0;  ///< when the first of them arrived here; 0: none waits
  std::uint64_t sent = 0;              ///< since start: reports new to the memory
  std::uint64_t received = 0;          ///< since start: reports new here
  std::uint64_t refused = 0;           ///< refused reports: retried with each connection
  std::string first_refused;           ///< one of them, with the reason
  std::uint64_t left_out = 0;          ///< since start: their paths are dropped or damaged
  std::uint64_t retired_above = 0;     ///< since start: paths, because they were retired here
  std::uint64_t retired_here = 0;      ///< since start: paths, because they were retired above
  std::uint64_t tasks = 0;             ///< whose experience comes down
};

template <>
inline constexpr std::tuple kFieldsOf<UpstreamStatus>{
    Field{"name", &UpstreamStatus::name, {.limit = kMaxMessageBytes}},
    Field{"connected", &UpstreamStatus::connected},
    Field{"since_ms", &UpstreamStatus::since_ms},
    Field{"message", &UpstreamStatus::message, {.limit = kMaxPageBytes}},
    Field{"tries", &UpstreamStatus::tries},
    Field{"waiting", &UpstreamStatus::waiting},
    Field{"oldest_waiting_ms", &UpstreamStatus::oldest_waiting_ms},
    Field{"sent", &UpstreamStatus::sent},
    Field{"received", &UpstreamStatus::received},
    Field{"refused", &UpstreamStatus::refused},
    Field{"first_refused", &UpstreamStatus::first_refused, {.limit = kMaxPageBytes}},
    Field{"left_out", &UpstreamStatus::left_out},
    Field{"retired_above", &UpstreamStatus::retired_above},
    Field{"retired_here", &UpstreamStatus::retired_here},
    Field{"tasks", &UpstreamStatus::tasks}};

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
  std::string storage_message;          ///< why it is not writable, or a warning
  std::uint64_t rehearsals = 0;         ///< done since start
  std::uint64_t queued_rehearsals = 0;  ///< waiting or running
  double rehearsal_time_s = 0;          ///< processor time of the done ones
  std::uint64_t rollbacks = 0;          ///< of the store, noticed since start
  std::int64_t scrubbed_ms = 0;         ///< when the store was last scanned for damage; 0: never
  double scrub_part = 0;                ///< 0 to 1: part of it scanned since then
  std::vector<TroubleCount> troubles = {};
  std::vector<BoundUse> bounds = {};
  std::uint64_t dropped_paths = 0;              ///< beyond the cap of their robot and task, in all
  std::int64_t credentials_expire_ms = 0;       ///< the server's own; 0: it runs without security
  std::optional<UpstreamStatus> upstream = {};  ///< of a site
  std::vector<ReplicaUse> replicas = {};        ///< hosts of a database that fits may read
  /// Goes into the proof that a change needs (AdminRequest::proof); empty: none is needed.
  std::string challenge = {};
  std::uint64_t meshes = 0;                                        ///< contents of robots' meshes
  std::uint64_t mesh_bytes = 0;                                    ///< of them, compressed
  std::optional<PathMeans> guided_means = {}, control_means = {};  ///< of all robots and tasks
};

template <>
inline constexpr std::tuple kFieldsOf<ServerStatus>{
    Field{"version", &ServerStatus::version, {.limit = kMaxMessageBytes}},
    Field{"store_file", &ServerStatus::store_file, {.limit = kMaxPageBytes}},
    Field{"store_epoch", &ServerStatus::store_epoch},
    Field{"schema_version", &ServerStatus::schema_version},
    Field{"uptime_s", &ServerStatus::uptime_s},
    Field{"robots", &ServerStatus::robots},
    Field{"tasks", &ServerStatus::tasks},
    Field{"paths", &ServerStatus::paths},
    Field{"attempts", &ServerStatus::attempts},
    Field{"distributions", &ServerStatus::distributions},
    Field{"reports_received", &ServerStatus::reports_received},
    Field{"reports_refused", &ServerStatus::reports_refused},
    Field{"fetches", &ServerStatus::fetches},
    Field{"fetches_from_memory", &ServerStatus::fetches_from_memory},
    Field{"fits", &ServerStatus::fits},
    Field{"queued_reports", &ServerStatus::queued_reports},
    Field{"queued_fits", &ServerStatus::queued_fits},
    Field{"followed", &ServerStatus::followed},
    Field{"jobs", &ServerStatus::jobs},
    Field{"store_bytes", &ServerStatus::store_bytes},
    Field{"writable", &ServerStatus::writable},
    Field{"storage_message", &ServerStatus::storage_message, {.limit = kMaxPageBytes}},
    Field{"rehearsals", &ServerStatus::rehearsals, {.may_be_missing = true}},
    Field{"queued_rehearsals", &ServerStatus::queued_rehearsals, {.may_be_missing = true}},
    Field{"rehearsal_time_s", &ServerStatus::rehearsal_time_s, {.min = 0, .may_be_missing = true}},
    Field{"rollbacks", &ServerStatus::rollbacks, {.may_be_missing = true}},
    Field{"scrubbed_ms", &ServerStatus::scrubbed_ms, {.may_be_missing = true}},
    Field{"scrub_part", &ServerStatus::scrub_part, {.min = 0, .may_be_missing = true}},
    Field{"troubles", &ServerStatus::troubles, {.limit = kMaxStatusRows, .may_be_missing = true}},
    Field{"bounds", &ServerStatus::bounds, {.limit = kMaxStatusRows, .may_be_missing = true}},
    Field{"dropped_paths", &ServerStatus::dropped_paths, {.may_be_missing = true}},
    Field{"credentials_expire_ms", &ServerStatus::credentials_expire_ms, {.may_be_missing = true}},
    Field{"upstream", &ServerStatus::upstream, {.may_be_missing = true}},
    Field{"replicas", &ServerStatus::replicas, {.limit = kMaxStatusRows, .may_be_missing = true}},
    Field{"challenge", &ServerStatus::challenge, {.limit = kMaxWordBytes, .may_be_missing = true}},
    Field{"meshes", &ServerStatus::meshes, {.may_be_missing = true}},
    Field{"mesh_bytes", &ServerStatus::mesh_bytes, {.may_be_missing = true}},
    Field{"guided_means", &ServerStatus::guided_means, {.may_be_missing = true}},
    Field{"control_means", &ServerStatus::control_means, {.may_be_missing = true}}};

/// A row of the admin conversation, and its name in a refusal.
template <typename Row>
struct RowName {
  std::string_view name;
};

/// Every row that is written by a table of its fields, and Explanation.
inline constexpr std::tuple kAdminRows{RowName<RobotSummary>{"robot"},
                                       RowName<TaskSummary>{"task"},
                                       RowName<PathSummary>{"path"},
                                       RowName<AttemptSummary>{"attempt"},
                                       RowName<DistributionSummary>{"distribution"},
                                       RowName<ServerStatus>{"status"},
                                       RowName<Explanation>{"explanation"},
                                       RowName<Eviction>{"eviction"},
                                       RowName<Retirement>{"retirement"},
                                       RowName<RobotRemoval>{"robot removal"},
                                       RowName<Job>{"job"},
                                       RowName<ClientUse>{"client"},
                                       RowName<BackupSummary>{"backup"},
                                       RowName<AuditEntry>{"audit entry"},
                                       RowName<StoredMesh>{"mesh"},
                                       RowName<Restoration>{"restoration"},
                                       RowName<TaskRemoval>{"task removal"}};

}  // namespace kinship
