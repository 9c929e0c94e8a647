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
#include "server/store/shared_report.hpp"

namespace kinship::store {

/// A robot as stored. Its digest and dof were computed by the caller.
struct RobotRecord {
  Digest digest;
  RobotDescription description;
  std::uint32_t dof = 0;
  std::int64_t registered_ms = 0;
  std::uint64_t geometry_revision = 0;  ///< how often better geometry was taken over
  std::int64_t geometry_ms = 0;         ///< when last; 0: never
};

/// A path with what a transfer needs to know about it.
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
  /// As they are at this generation of the robot and task or at a later one, which is never one
  /// from before what was read last; 0: as they are now.
  std::uint64_t generation = 0;
};

/// One (robot, task) pair that has, or had, paths.
struct ExperienceSummary {
  Digest robot;
  std::uint64_t paths = 0;  ///< without retired, dropped and damaged ones
  std::uint64_t generation = 0;
  std::uint64_t retired_generation = 0;  ///< when a path was retired last; 0: never
  std::uint64_t dropped = 0;             ///< paths that were beyond the cap, since ever
};

/// A robot and task that changed, and how it is now.
struct ChangedExperience {
  std::string task;
  ExperienceSummary now;
};

/// What anybody changed in a store since somebody looked.
struct StoreChanges {
  std::string cursor;                         ///< for the next look
  std::vector<ChangedExperience> experience;  ///< new attempts, paths retired or dropped
  std::vector<Digest> robots;   ///< registered, renamed, with better geometry, or removed
  std::vector<Digest> evicted;  ///< distributions, by somebody; not for want of room
};

/// The right to fit a distribution, which one server of a store has at a time.
struct FitRight {
  std::uint64_t fence =
      0;  ///< greater than that of anybody who had it before; 0: there is one server
};

/// What the attempts in one sampling mode sum up to; the sums from which a ratio's interval
/// follows.
struct ModeTotals {
  std::uint64_t attempts = 0;
  std::uint64_t solved = 0;
  double checks = 0;            ///< collision checks, of solved and unsolved ones
  double checks_squared = 0;    ///< sum of their squares
  double checks_of_solved = 0;  ///< of the solved ones alone
};

/// A judged attempt and what it was planned with.
struct KnownAttempt {
  JudgedAttempt judged;
  std::string planner = {};
  std::optional<Digest> distribution_id = {};  ///< missing: the client did not say

  bool operator==(const KnownAttempt&) const = default;
};

/// So many of each sampling mode are known, whatever they were planned with: more than are judged,
/// which are those of one planner.
inline constexpr std::size_t kKnownAttemptsPerMode = 2 * kJudgedAttemptsPerMode;

/// The attempts of one robot and task, by sampling mode.
struct AttemptTotals {
  ModeTotals guided, control;
  std::vector<KnownAttempt> recent;  ///< the newest kKnownAttemptsPerMode of each, oldest first
};

/// What became of a robot that was removed, and of what was made with it.
struct RemovedRobot {
  RobotRemoval removal;
  std::vector<std::string> tasks;     ///< of its attempts and distributions
  std::vector<Digest> distributions;  ///< for it, which are gone
};

/// How far a store has come: what had a receipt by then is in it as long as the mark lies on its
/// history.
struct StorePoint {
  Uuid epoch;
  HistoryMark mark;  ///< of the newest attempt that is durable
};

struct StoreStatus {
  std::string file;
  Uuid epoch;
  std::uint32_t schema_version = 0;
  std::uint64_t robots = 0, tasks = 0, paths = 0, attempts = 0, distributions = 0;
  std::uint64_t dropped_paths = 0;       ///< were beyond the cap of their robot and task
  std::uint64_t most_paths_of_pair = 0;  ///< that a robot and task have
  std::uint64_t max_paths_per_pair = 0;  ///< 0: no cap
  std::uint64_t bytes = 0;
  std::uint64_t distribution_bytes = 0;      ///< of them, about
  std::uint64_t max_distribution_bytes = 0;  ///< 0: no limit
  std::uint64_t queued = 0;
  std::uint64_t wal_bytes = 0;  ///< in use, of changes that are not yet in the file
  bool writable = true;
  bool damaged = false;  ///< something was found that cannot be read any more; `message` names it
  std::int64_t scrubbed_ms =
      0;                  ///< when all of the file was last read in search of damage; 0: never
  double scrub_part = 0;  ///< how far the search for damage is since then
  std::string message;  ///< why not writable, what is damaged, warnings; mostly one warning or none
  std::uint64_t rollbacks = 0;       ///< noticed since it was opened, each with a new epoch
  std::vector<ReplicaUse> replicas;  ///< hosts of a database that fits may read
};

/// One page of a listing; `next_cursor` is empty on the last one.
template <typename Row>
struct Page {
  std::vector<Row> rows;
  std::string next_cursor;
};

/// Keeps robots, attempts, paths and distributions. Every method may be called from any thread.
/// Reads see committed data only. Unless said otherwise methods throw Failure(Storage).
///
/// What administrators ask for takes an `audit`: who asks for what. The store keeps it in the audit
/// log, with what was before and is after, in the transaction of the change; where there are
/// several, the first says Begun and the last Done. What is not done leaves no entry. Null: none is
/// kept.
class Store {
 public:
  virtual ~Store() = default;

  /// Ends every wait for a database that does not answer, from any thread: what waits, and
  /// whatever is asked for from now on, throws. For who stops. Nothing where files are read.
  virtual void stop_waiting() noexcept {}

  /// Of the store's life: changes when it is restored, or was found to be a copy or rolled back.
  virtual Uuid epoch() const = 0;
  virtual StorePoint point() const = 0;

  /// Whether a mark that a client was given is one of this epoch and what was there then is not any
  /// more. Marks that this store never made are not lost. A shared store may have to be read for
  /// it; what cannot be read counts as not lost.
  virtual bool has_lost(const HistoryMark& mark) const = 0;
  /// Whether has_lost() is worth asking. From memory.
  virtual bool may_have_lost(const HistoryMark& mark) const { return has_lost(mark); }
  /// A new epoch if a mark is lost, durable on return. \return whether it began.
  virtual bool begin_epoch_if_lost(const HistoryMark& mark) = 0;
  virtual StoreStatus status() const = 0;

  /// Durable on return. Known: the digest was there already (its label and text stay as they are).
  /// A damaged row of this digest is written anew from `robot` and keeps its paths: Registered.
  /// \return Conflict if another robot has the label; InvalidInput if a value cannot be kept.
  virtual Result<RegisterStatus> register_robot(const RobotRecord& robot) = 0;
  /// Takes over a known robot's description with better geometry; its label and when it was
  /// registered stay. Durable on return.
  /// \param robot  its geometry_revision is one more than that of the robot as it is known.
  /// \return false, and nothing changes, if it is not: somebody else was first; or if the row is
  ///         damaged or not there.
  virtual bool replace_geometry(const RobotRecord& robot) = 0;
  /// Gives a robot another label, durable on return; the one it had is free from then on. A client
  /// that registers it under the old one is answered Known.
  /// \return NotFound for an unknown robot; Conflict if another robot has the label; InvalidInput
  ///         for what is no label.
  virtual Result<bool> rename_robot(const Digest& robot, const std::string& label,
                                    const AuditEntry* audit = nullptr) = 0;
  /// Takes a robot out, durable on return: its label is free, it is neither found nor listed, its
  /// distributions are gone and its paths retired. One without attempts is deleted. Of another its
  /// attempts, paths and UUIDs stay for the record; registered again it is Registered, gets the
  /// label that it brings, and what it reports anew counts; what was retired stays retired.
  ///
  /// All of it is one transaction, the last: before it, paths beyond some hundreds are retired in
  /// transactions of their own, and who stops or fails between them leaves a robot that has fewer
  /// paths.
  /// \param stop  looked at between them.
  /// \return NotFound for an unknown robot; Unavailable if it was stopped.
  virtual Result<RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop = {},
                                            const AuditEntry* audit = nullptr) = 0;
  /// Of robots whose geometry was ever taken over anew.
  virtual std::map<Digest, std::uint64_t> geometry_revisions() const = 0;
  virtual std::optional<RobotRecord> find_robot(const Digest& robot) const = 0;
  /// By label. A robot whose row is damaged is left out and counted in status().message;
  /// find_robot() throws for it.
  virtual std::vector<RobotRecord> robots() const = 0;

  using ReportsDone = std::function<void(const std::vector<Receipt>&)>;

  /// Queues checked attempts; `done` is called on the writer thread after the commit is durable
  /// (or failed, or there is no room to wait: TryAgain), one receipt per attempt in order. What
  /// waits together is committed together. `done` must not throw, block or wait for a write. Never
  /// throws Storage.
  ///
  /// Same UUID and body: Duplicate. Same UUID, other body: Refused. A robot that is not registered
  /// (any more): UnknownRobot. A path whose content (waypoints
  /// and snapped placement, or none) the (robot, task) has already is recorded as an attempt and
  /// answered Duplicate.
  ///
  /// Where a robot and task have as many paths as they may (an option of the engine), those with
  /// the smallest content digests are kept. A path that is none of them is answered Recorded, and
  /// why; one that was Stored may make another one drop, which is in no reading from then on and
  /// raises the generation, but not retired_generation: what was fitted with it is as good as
  /// before. Its attempt and UUID stay, its waypoints do not.
  virtual void commit_reports(std::vector<Attempt> attempts, ReportsDone done) = 0;

  /// The robots that have, or had, paths of a task, by digest.
  virtual std::vector<ExperienceSummary> experience(std::string_view task) const = 0;
  virtual std::uint64_t generation(const Digest& robot, std::string_view task) const = 0;

  /// Paths of one robot and task in the order of ids. A path whose blob fails its CRC is set aside
  /// (kept, marked damaged, counted in status().message) and left out; retired and dropped ones are
  /// left out.
  virtual std::vector<StoredPath> read_paths(const Digest& robot, std::string_view task,
                                             const PathRange& range) const = 0;

  /// The ids of these paths, ascending, without a look at the paths themselves.
  /// \param generation  see PathRange.
  virtual std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                             std::uint64_t generation = 0) const = 0;

  /// The scene of a path: equal ids, equal scenes. Nothing if it is not there or damaged; one whose
  /// blob fails its CRC is set aside (kept, marked damaged, counted in status().message) until a
  /// report brings it anew; its paths are read all the same.
  virtual std::optional<RecordedScene> read_scene(std::int64_t scene_id) const = 0;

  /// Takes a path, or all paths of a task, out of every fit, durable on return. They are kept for
  /// the record, their report UUIDs stay known, and their content may be reported anew. Raises
  /// generation and retired_generation of each (robot, task) that lost a path.
  /// A reset is made of many transactions; what throws in the midst of it leaves some of the paths
  /// retired.
  /// \param stop  looked at between them.
  /// \return what was retired; NotFound for an unknown report or task; InvalidInput for a report
  ///         that brought no path; Unavailable, with what was retired until then, for a reset that
  ///         was stopped.
  virtual Result<Retirement> retire_path(const Uuid& report_uuid,
                                         const AuditEntry* audit = nullptr) = 0;
  virtual Result<Retirement> reset_task(std::string_view task, const std::stop_token& stop = {},
                                        const AuditEntry* audit = nullptr) = 0;

  /// Whether other servers may have it open, too: then whoever asks it may have to wait for another
  /// machine, and changes_since() tells what the others did.
  virtual bool is_shared() const { return false; }
  /// What was changed since a look, by this server or another of the same store; what is on its way
  /// meanwhile is in the next look. Something may be told twice.
  /// \param cursor  of the look before; empty: from now on, nothing is told.
  /// \return nothing where a store has one server, which knows what it did.
  virtual std::optional<StoreChanges> changes_since(std::string_view cursor) const {
    (void)cursor;
    return std::nullopt;
  }

  virtual AttemptTotals attempt_totals(const Digest& robot, std::string_view task) const = 0;

  /// Stores a distribution under its id with the next revision, durable on return. Where all of
  /// them take more than they may (an option of the engine), those not used for longest are
  /// forgotten. \return the revision given, greater than any that this id had. \throws
  /// Failure(NotFound) if its robot is not registered, Failure(InvalidInput) if a part
  ///         exceeds its limit.
  /// \param right  with which it was fitted. \throws Failure(Unavailable), and nothing is stored,
  /// if
  ///               another server has it since.
  virtual std::uint64_t put_distribution(const Distribution& distribution,
                                         const FitRight& right = {}) = 0;
  /// Takes the right to fit a distribution. Of a server that died it is free a few seconds later.
  /// \return nothing while another server has it.
  virtual std::optional<FitRight> take_fit_right(const Digest& id) {
    (void)id;
    return FitRight{};
  }
  /// Others may have it from now on. Never throws: what is not given back is free once the server
  /// takes it again or ends.
  virtual void give_back_fit_right(const Digest& id, const FitRight& right) noexcept {
    (void)id;
    (void)right;
  }
  /// The newest revision; nothing if its payload fails its CRC.
  virtual std::optional<Distribution> find_distribution(const Digest& id) const = 0;
  /// Says that a distribution was served; precise to the hour, lost in a crash. Returns at once.
  virtual void note_use(const Digest& id) const = 0;
  /// Forgets the mixture of a distribution, durable on return; its next fit gets the next revision.
  /// \return whether it was there.
  virtual bool evict_distribution(const Digest& id, const AuditEntry* audit = nullptr) = 0;

  /// Adds an entry of now to the audit log, durable on return; its number is given here. Nothing
  /// changes or removes it.
  virtual void add_audit(const AuditEntry& entry) = 0;

  /// Listings: at most `limit` rows after `cursor`, which is empty for the first page. What comes
  /// or goes between two pages neither repeats nor hides other rows. `solver` of a robot is left
  /// empty. \throws Failure(InvalidInput) for a cursor of another listing.
  virtual Page<RobotSummary> list_robots(std::string_view cursor, std::size_t limit) const = 0;
  virtual Page<TaskSummary> list_tasks(std::string_view cursor, std::size_t limit) const = 0;
  virtual std::optional<TaskSummary> find_task(std::string_view task) const = 0;
  /// The last to arrive first, retired and dropped ones too. Empty robot or task: all.
  virtual Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                                       std::string_view cursor, std::size_t limit) const = 0;
  /// By arrival, unsolved ones and those of retired paths too. Empty robot or task: all.
  virtual Page<AttemptSummary> list_attempts(const std::optional<Digest>& robot,
                                             std::string_view task, std::string_view cursor,
                                             std::size_t limit) const = 0;
  /// An attempt with its path and scene, by report UUID; unsolved ones too. Without its path if
  /// that one is damaged or dropped, without its scene if that one is damaged.
  virtual std::optional<Attempt> find_attempt(const Uuid& report_uuid) const = 0;
  /// Attempts with their paths and scenes for export, oldest first; without the
  /// attempts of retired, dropped and damaged paths. A page ends early once its waypoints and
  /// scenes (as scene_bytes() counts) exceed `max_bytes`, but holds one at least.
  virtual Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                        std::string_view cursor, std::size_t limit,
                                        std::size_t max_bytes) const = 0;
  /// The last to be fitted first; one that is fitted again between two pages goes to the front.
  virtual Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                                       std::string_view task,
                                                       std::string_view cursor,
                                                       std::size_t limit) const = 0;

  /// The audit log, the newest first. Empty name: of all.
  virtual Page<AuditEntry> list_audit(std::string_view name, std::string_view cursor,
                                      std::size_t limit) const = 0;

  /// What another store is to be told (shared_report.hpp). A feed is in the order of arrival; its
  /// cursor is opaque text, empty for the beginning, and holds for one epoch. However many write at
  /// once: what is committed before a reading begins and behind its cursor is in it, or in one from
  /// the cursor that it returns; nothing is skipped because somebody else committed sooner.
  /// \throws Failure(InvalidInput) for a cursor of something else.
  ///
  /// The reports of a task, or of all if it is empty: unsolved ones too, and those of retired and
  /// dropped paths.
  virtual Feed<ArrivedReport> list_arrivals(std::string_view task, std::string_view cursor,
                                            std::size_t limit) const = 0;
  /// Every report whose path somebody retired here, or which another store said was retired; each
  /// once. Paths that were dropped are not among them.
  virtual Feed<Uuid> list_retirements(std::string_view cursor, std::size_t limit) const = 0;
  /// Those of the reports that are here.
  virtual std::set<Uuid> known_reports(std::span<const Uuid> reports) const = 0;
  /// Reports with their paths and scenes, also of retired paths, in the order asked for. Left out:
  /// what is not here or cannot be read, what is solved and has lost its path (dropped, damaged),
  /// what is of a removed robot. Ends early once waypoints and scenes exceed `max_bytes`, but looks
  /// at one at least.
  virtual SharedReports read_reports(std::span<const Uuid> reports,
                                     std::size_t max_bytes) const = 0;
  /// commit_reports() of what came from another store: body and time are kept as they are, and a
  /// path that is retired, or whose report is among the retired ones, is stored as such and
  /// answered Recorded. So is, from then on, one that a robot brings. A report that is here already
  /// and is retired there is retired here.
  virtual void commit_shared(std::vector<SharedReport> reports, ReportsDone done) = 0;
  /// Retires the paths of reports as another store did, durable on return, in one transaction. Of
  /// what is not here (yet) the UUID is remembered, so that its path will be retired when it comes.
  /// \return by task, what was not retired before.
  virtual std::vector<Retirement> retire_reports(std::span<const Uuid> reports) = 0;

  /// Short texts that a part of the server keeps by name, by the beginning of their names.
  virtual std::map<std::string, std::string> notes(std::string_view prefix) const = 0;
  /// Durable on return, all of them or none; one without text is removed.
  virtual void put_notes(const std::map<std::string, std::optional<std::string>>& notes) = 0;

  /// Copies the store as of one instant into a new file, while reports go on. A file that is not
  /// complete never has that name.
  /// \param progress  called now and then with 0 to 1; false ends the copy with nothing kept.
  /// \return false if `progress` ended it; Conflict if the file is there already; Unavailable if
  ///         another backup is on its way.
  /// \throws Failure(Storage) that names the file.
  virtual Result<bool> backup(const std::filesystem::path& file,
                              const std::function<bool(double)>& progress) const = 0;
};

}  // namespace kinship::store
