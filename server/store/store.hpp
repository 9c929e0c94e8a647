#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/audit.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "server/store/replicated_report.hpp"

namespace kinship::store {

/// A robot as stored. Its digest and dof were computed by the caller.
struct RobotRecord {
  Digest digest;
  RobotDescription description;
  std::uint32_t dof = 0;
  std::int64_t registered_ms = 0;
  std::uint64_t geometry_revision = 0;  ///< how often better geometry replaced it
  std::int64_t geometry_ms = 0;         ///< last replacement; 0: never
};

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

/// A robot and task that changed, and its current summary.
struct ChangedExperience {
  std::string task;
  ExperienceSummary now;
};

/// Changes of a store since an earlier look, by any server.
struct StoreChanges {
  std::string cursor;                         ///< for the next look
  std::vector<ChangedExperience> experience;  ///< new attempts, paths retired or dropped
  std::vector<Digest> robots;   ///< registered, renamed, with better geometry, or removed
  std::vector<Digest> evicted;  ///< distributions, on request; not for want of room
};

/// The right to fit a distribution, which one server of a store has at a time.
struct FitRight {
  /// Greater than the fence of every earlier holder; 0: there is one server.
  std::uint64_t fence = 0;
};

/// Sums over the attempts in one sampling mode, from which the interval of a ratio follows.
struct ModeTotals {
  std::uint64_t attempts = 0;
  std::uint64_t solved = 0;
  double checks = 0;            ///< collision checks, of solved and unsolved ones
  double checks_squared = 0;    ///< sum of their squares
  double checks_of_solved = 0;  ///< of the solved ones alone
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

/// A removed robot, and its experience and distributions.
struct RemovedRobot {
  RobotRemoval removal;
  std::vector<std::string> tasks;     ///< of its attempts and distributions
  std::vector<Digest> distributions;  ///< of the robot, which are gone
};

/// How far a store has come: it has every report with a receipt up to this point as long as the
/// point lies on its history.
struct StorePoint {
  Uuid epoch;
  ConsistencyToken token;  ///< of the newest attempt that is durable
};

struct StoreStatus {
  std::string file;
  Uuid epoch;
  std::uint32_t schema_version = 0;
  std::uint64_t robots = 0, tasks = 0, paths = 0, attempts = 0, distributions = 0;
  std::uint64_t dropped_paths = 0;       ///< beyond the cap of their robot and task
  std::uint64_t most_paths_of_pair = 0;  ///< of one robot and task
  std::uint64_t max_paths_per_pair = 0;  ///< 0: no cap
  std::uint64_t bytes = 0;
  std::uint64_t distribution_bytes = 0;      ///< part of `bytes`, about
  std::uint64_t max_distribution_bytes = 0;  ///< 0: no limit
  std::uint64_t queued = 0;
  std::uint64_t wal_bytes = 0;  ///< in use: changes that are not yet in the file
  bool writable = true;
  bool damaged = false;  ///< something cannot be read any more; `message` names it
  /// End of the last complete search of the file for damage; 0: never.
  std::int64_t scrubbed_ms = 0;
  double scrub_part = 0;        ///< progress of the current search, 0 to 1
  std::string message;          ///< reason why not writable, damage, warnings; mostly one or none
  std::uint64_t rollbacks = 0;  ///< noticed since the store was opened, each with a new epoch
  std::vector<ReplicaUse> replicas;  ///< hosts of a database, for the readings of fits
};

/// One page of a listing; `next_cursor` is empty on the last one.
template <typename Row>
struct Page {
  std::vector<Row> rows;
  std::string next_cursor;
};

/// Keeps robots, attempts, paths and distributions. Every method may be called from any thread.
/// Reads see committed data only. Methods throw Failure(Storage) unless said otherwise.
///
/// Changes by an administrator take an `audit`, which names the administrator and the request. The
/// store adds it to the audit log, with the values before and after, in the transaction of the
/// change; of several transactions the first says Begun and the last Done. A change that is not
/// done leaves no entry. Null: no entry.
class Store {
 public:
  virtual ~Store() = default;

  /// To be called when the server stops, from any thread: ends every wait for a database that does
  /// not answer; waiting calls and all later ones throw. Does nothing for a file.
  virtual void stop_waiting() noexcept {}

  /// Names the store's history: changes when the store is restored, or turns out to be a copy or
  /// rolled back.
  virtual Uuid epoch() const = 0;
  virtual StorePoint point() const = 0;

  /// Whether a token is of this epoch and the store has lost reports that it had then. Tokens that
  /// this store never made are not lost. May read a shared store; if that fails the token counts as
  /// not lost.
  virtual bool has_lost(const ConsistencyToken& token) const = 0;
  /// Whether has_lost() may be true. From memory.
  virtual bool may_have_lost(const ConsistencyToken& token) const { return has_lost(token); }
  /// Begins a new epoch if a token is lost, durable on return. \return whether it began.
  virtual bool begin_epoch_if_lost(const ConsistencyToken& token) = 0;
  virtual StoreStatus status() const = 0;

  /// Durable on return. Known: the digest is registered already (its label and text stay). A
  /// damaged row of this digest is written anew from `robot` and keeps its paths: Registered.
  /// \return Conflict if another robot has the label; InvalidInput if a value cannot be kept.
  virtual Result<RegisterStatus> register_robot(const RobotRecord& robot) = 0;
  /// Replaces a known robot's description by one with better geometry; its label and registration
  /// time stay. Durable on return.
  /// \param robot  its geometry_revision is one more than the stored one.
  /// \return false, and nothing changes, if it is not, as after another call; or if the row is
  ///         damaged or missing.
  virtual bool replace_geometry(const RobotRecord& robot) = 0;
  /// Gives a robot another label, durable on return; the old label is free from then on. A client
  /// that registers the robot under the old label is answered Known.
  /// \return NotFound for an unknown robot; Conflict if another robot has the label; InvalidInput
  ///         if `label` is none.
  virtual Result<bool> rename_robot(const Digest& robot, const std::string& label,
                                    const AuditEntry* audit = nullptr) = 0;
  /// Removes a robot, durable on return: its label is free, it is neither found nor listed, its
  /// distributions are deleted and its paths retired. A robot without attempts is deleted.
  /// Otherwise its attempts, paths and UUIDs stay for the record; a new registration is answered
  /// Registered, with its own label, and new reports count; retired paths stay retired.
  ///
  /// The last transaction makes the removal. Before it, paths beyond some hundreds are retired in
  /// transactions of their own; a stop or failure between two of them leaves a robot with fewer
  /// paths.
  /// \param stop  checked between transactions.
  /// \return NotFound for an unknown robot; Unavailable if it was stopped.
  virtual Result<RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop = {},
                                            const AuditEntry* audit = nullptr) = 0;
  /// By robot; only robots whose geometry was ever replaced.
  virtual std::map<Digest, std::uint64_t> geometry_revisions() const = 0;
  virtual std::optional<RobotRecord> find_robot(const Digest& robot) const = 0;
  /// In order of labels. A robot with a damaged row is left out and counted in status().message;
  /// find_robot() throws for it.
  virtual std::vector<RobotRecord> robots() const = 0;

  using ReportsDone = std::function<void(const std::vector<Receipt>&)>;

  /// Queues checked attempts; `done` is called on the writer thread after the commit is durable (or
  /// failed, or the queue is full: TryAgain), one receipt per attempt in order. Queued attempts are
  /// committed together. `done` must not throw, block or wait for a write. Never throws Storage.
  ///
  /// Same UUID and body: Duplicate. Same UUID, other body: Refused. A robot that is not registered
  /// (any more): UnknownRobot. A path whose content (waypoints and snapped placement, or none) the
  /// robot and task have already: its attempt is recorded and answered Duplicate.
  ///
  /// At the cap of a robot and task (an option of the engine) the paths with the smallest content
  /// digests are kept. A path that is not kept is answered Recorded, with the reason; a Stored one
  /// may drop another path. Later readings leave a dropped path out; it raises the generation, but
  /// not retired_generation, as a distribution fitted with it is as good as before. Its attempt and
  /// UUID stay, its waypoints do not.
  virtual void commit_reports(std::vector<Attempt> attempts, ReportsDone done) = 0;

  /// The robots that have, or had, paths of a task, by digest.
  virtual std::vector<ExperienceSummary> experience(std::string_view task) const = 0;
  virtual std::uint64_t generation(const Digest& robot, std::string_view task) const = 0;

  /// Paths of one robot and task in order of ids, without retired and dropped ones. A path whose
  /// blob fails its CRC is quarantined (kept, marked damaged, counted in status().message) and left
  /// out.
  virtual std::vector<StoredPath> read_paths(const Digest& robot, std::string_view task,
                                             const PathRange& range) const = 0;

  /// The ids of these paths, ascending, without reading the paths.
  /// \param generation  see PathRange.
  virtual std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                             std::uint64_t generation = 0) const = 0;

  /// The scene of a path: equal ids, equal scenes. Nothing if it is missing or damaged; one whose
  /// blob fails its CRC is quarantined (kept, marked damaged, counted in status().message) until a
  /// report brings it again; its paths are still read.
  virtual std::optional<RecordedScene> read_scene(std::int64_t scene_id) const = 0;

  /// Retires a path, or all paths of a task, durable on return: no fit uses them. They are kept for
  /// the record, their report UUIDs stay known, and their content may be reported again. Raises
  /// generation and retired_generation of each (robot, task) that lost a path. A reset takes many
  /// transactions; an exception between them leaves some of the paths retired.
  /// \param stop  checked between transactions.
  /// \return the retired paths; NotFound for an unknown report or task; InvalidInput for a report
  ///         without a path; Unavailable, with the paths retired until then, if a reset was
  ///         stopped.
  virtual Result<Retirement> retire_path(const Uuid& report_uuid,
                                         const AuditEntry* audit = nullptr) = 0;
  virtual Result<Retirement> reset_task(std::string_view task, const std::stop_token& stop = {},
                                        const AuditEntry* audit = nullptr) = 0;

  /// Whether other servers may have it open, too: then a call may wait for another machine, and
  /// changes_since() reports the changes of the others.
  virtual bool is_shared() const { return false; }
  /// Changes since the last look, by this server or another of the same store; changes under way
  /// are in the next look. A change may be reported twice.
  /// \param cursor  of the last look; empty: begins now, without changes.
  /// \return nothing if the store has one server, which knows its own changes.
  virtual std::optional<StoreChanges> changes_since(std::string_view cursor) const {
    (void)cursor;
    return std::nullopt;
  }

  virtual AttemptTotals attempt_totals(const Digest& robot, std::string_view task) const = 0;

  /// Stores a distribution under its id with the next revision, durable on return. Beyond the limit
  /// of all distributions (an option of the engine) the least recently used ones are deleted.
  /// \param right  with which it was fitted.
  /// \return the revision, greater than every earlier one of this id.
  /// \throws Failure(NotFound) if its robot is not registered; Failure(InvalidInput) if a part
  ///         exceeds its limit; Failure(Unavailable), and nothing is stored, if another server has
  ///         taken the right since.
  virtual std::uint64_t put_distribution(const Distribution& distribution,
                                         const FitRight& right = {}) = 0;
  /// Takes the right to fit a distribution. It is free a few seconds after its server died.
  /// \return nothing while another server has it.
  virtual std::optional<FitRight> take_fit_right(const Digest& id) {
    (void)id;
    return FitRight{};
  }
  /// Frees the right for other servers. Never throws: a right that is not given back is free once
  /// the server takes it again or ends.
  virtual void give_back_fit_right(const Digest& id, const FitRight& right) noexcept {
    (void)id;
    (void)right;
  }
  /// The newest revision; nothing if its payload fails its CRC.
  virtual std::optional<Distribution> find_distribution(const Digest& id) const = 0;
  /// Notes that a distribution was served; precise to the hour, lost in a crash. Returns at once.
  virtual void note_use(const Digest& id) const = 0;
  /// Evicts a distribution, durable on return; its next fit gets the next revision.
  /// \return whether it existed.
  virtual bool evict_distribution(const Digest& id, const AuditEntry* audit = nullptr) = 0;

  /// Adds an entry to the audit log, durable on return, with the current time and the next number.
  /// Entries are never changed or removed.
  virtual void add_audit(const AuditEntry& entry) = 0;

  /// Listings: at most `limit` rows after `cursor`, which is empty for the first page. Rows added
  /// or removed between two pages neither repeat nor hide others. `solver` of a robot is left
  /// empty. \throws Failure(InvalidInput) for a cursor of another listing.
  virtual Page<RobotSummary> list_robots(std::string_view cursor, std::size_t limit) const = 0;
  virtual Page<TaskSummary> list_tasks(std::string_view cursor, std::size_t limit) const = 0;
  virtual std::optional<TaskSummary> find_task(std::string_view task) const = 0;
  /// The newest first, retired and dropped ones too. Empty robot or task: all.
  virtual Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                                       std::string_view cursor, std::size_t limit) const = 0;
  /// In order of arrival, unsolved ones and those of retired paths too. Empty robot or task: all.
  virtual Page<AttemptSummary> list_attempts(const std::optional<Digest>& robot,
                                             std::string_view task, std::string_view cursor,
                                             std::size_t limit) const = 0;
  /// An attempt with its path and scene, by report UUID; unsolved ones too. Without its path if
  /// that is damaged or dropped, without its scene if that is damaged.
  virtual std::optional<Attempt> find_attempt(const Uuid& report_uuid) const = 0;
  /// Attempts with their paths and scenes for export, oldest first; without the attempts of
  /// retired, dropped and damaged paths. A page ends early once its waypoints and scenes (as
  /// scene_bytes() counts) exceed `max_bytes`, but has at least one.
  virtual Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                        std::string_view cursor, std::size_t limit,
                                        std::size_t max_bytes) const = 0;
  /// The newest fit first; a distribution fitted again between two pages goes to the front.
  virtual Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                                       std::string_view task,
                                                       std::string_view cursor,
                                                       std::size_t limit) const = 0;

  /// The audit log, the newest first. Empty name: all entries.
  virtual Page<AuditEntry> list_audit(std::string_view name, std::string_view cursor,
                                      std::size_t limit) const = 0;

  /// Feeds for another store (replicated_report.hpp). A feed is in the order of arrival; its cursor
  /// is opaque text, empty for the beginning, and holds for one epoch. With any number of writers,
  /// rows committed before a reading begins and behind its cursor are in it, or in one from the
  /// cursor that it returns; no row is skipped because another transaction committed sooner.
  /// \throws Failure(InvalidInput) for a cursor of another list.
  ///
  /// The reports of a task, or of all if it is empty: unsolved ones too, and those of retired and
  /// dropped paths.
  virtual Feed<ArrivedReport> list_arrivals(std::string_view task, std::string_view cursor,
                                            std::size_t limit) const = 0;
  /// Every report whose path was retired here, or by a retirement from another store; each once.
  /// Dropped paths are not among them.
  virtual Feed<Uuid> list_retirements(std::string_view cursor, std::size_t limit) const = 0;
  /// The given reports that this store has.
  virtual std::set<Uuid> known_reports(std::span<const Uuid> reports) const = 0;
  /// Reports with their paths and scenes, also of retired paths, in the order asked for. Left out:
  /// reports that are missing or unreadable, solved ones that lost their path (dropped, damaged),
  /// and those of a removed robot. Ends early once waypoints and scenes exceed `max_bytes`, but
  /// looks at one at least.
  virtual ReplicatedReports read_reports(std::span<const Uuid> reports,
                                         std::size_t max_bytes) const = 0;
  /// commit_reports() for reports from another store: body and time are kept, and a path that is
  /// retired, or whose report is among the retired ones, is stored as retired and answered
  /// Recorded. The same then holds for such a path from a robot. A known report that is retired
  /// there is retired here.
  virtual void commit_replicated(std::vector<ReplicatedReport> reports, ReportsDone done) = 0;
  /// Retires the paths of reports that another store retired, durable on return, in one
  /// transaction. The UUID of an unknown report is kept, so that its path is retired on arrival.
  /// \return the newly retired paths, by task.
  virtual std::vector<Retirement> retire_reports(std::span<const Uuid> reports) = 0;

  /// Short texts that a part of the server keeps by name; the ones whose names begin with `prefix`.
  virtual std::map<std::string, std::string> notes(std::string_view prefix) const = 0;
  /// Writes all of them or none, durable on return; a note without text is removed.
  virtual void put_notes(const std::map<std::string, std::optional<std::string>>& notes) = 0;

  /// Copies the store as of one instant into a new file, while reports go on. Only a complete file
  /// has that name.
  /// \param progress  called now and then with 0 to 1; false ends the copy with nothing kept.
  /// \return false if `progress` ended it; Conflict if the file exists; Unavailable if another
  ///         backup is running.
  /// \throws Failure(Storage) that names the file.
  virtual Result<bool> backup(const std::filesystem::path& file,
                              const std::function<bool(double)>& progress) const = 0;
};

}  // namespace kinship::store
