#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/page.hpp"

namespace kinship::store {

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
  std::uint64_t search_bytes = 0;            ///< of search records, part of `bytes`, about
  std::uint64_t max_search_bytes = 0;        ///< 0: none is kept
  std::uint64_t meshes = 0;                  ///< contents of robots' meshes
  std::uint64_t mesh_bytes = 0;              ///< of these, compressed; part of `bytes`
  /// Over all robots and tasks; missing: none were measured.
  std::optional<PathMeans> guided_means = {}, control_means = {};
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

/// A removed task, and the ids of its deleted distributions.
struct RemovedTask {
  TaskRemoval removal;
  std::vector<Digest> distributions;
};

/// Tells a store's status, retires experience, keeps the audit log and makes backups; see Store.
class AdminStore {
 public:
  virtual StoreStatus status() const = 0;

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

  /// Gives a task another name, durable on return: its paths, attempts and retirements are those of
  /// the new name, its distributions and rehearsals are deleted. Raises generation and
  /// retired_generation of its pairs. A report that names the old task, also one from
  /// another store, begins a task of that name; one that is known already stays known.
  /// \return the deleted distributions; NotFound for an unknown task; Conflict if there is one of
  ///         the new name, also a removed one.
  virtual Result<std::vector<Digest>> rename_task(std::string_view task, std::string_view name,
                                                  const AuditEntry* audit = nullptr) = 0;
  /// reset_task(), then deletes the distributions of the task and lists it no more, until another
  /// attempt of it arrives. Attempts and paths stay for the record.
  /// \return NotFound for an unknown task; Unavailable as reset_task().
  virtual Result<RemovedTask> remove_task(std::string_view task, const std::stop_token& stop = {},
                                          const AuditEntry* audit = nullptr) = 0;

  /// Adds an entry to the audit log, durable on return, with the current time and the next number.
  /// Entries are never changed or removed.
  virtual void add_audit(const AuditEntry& entry) = 0;
  /// The audit log, the newest first. Empty name: all entries.
  virtual Page<AuditEntry> list_audit(std::string_view name, std::string_view cursor,
                                      std::size_t limit) const = 0;

  /// Copies the store as of one instant into a new file, while reports go on. Only a complete file
  /// has that name.
  /// \param progress  called now and then with 0 to 1; false ends the copy with nothing kept.
  /// \return false if `progress` ended it; Conflict if the file exists; Unavailable if another
  ///         backup is running.
  /// \throws Failure(Storage) that names the file.
  virtual Result<bool> backup(const std::filesystem::path& file,
                              const std::function<bool(double)>& progress) const = 0;

 protected:
  ~AdminStore() = default;
};

}  // namespace kinship::store
