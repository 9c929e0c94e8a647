#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "proto/types/caller.hpp"

/// The verbs of the admin conversation: the name, answer, role and effect of each.
namespace kinship {

/// Numbered as on the wire: a new verb comes last.
enum class AdminVerb {
  Status,                ///< row: ServerStatus
  ListRobots,            ///< rows: RobotSummary
  ShowRobot,             ///< rows: RobotSummary, RobotDescription
  ListTasks,             ///< rows: TaskSummary
  ShowTask,              ///< row: TaskSummary
  ListPaths,             ///< rows: PathSummary; filters robot and task
  ShowPath,              ///< row: Attempt, also an unsolved one
  ListDistributions,     ///< rows: DistributionSummary; filters robot and task
  ShowDistribution,      ///< row: Distribution
  ExplainDistribution,   ///< row: Explanation
  EvictDistribution,     ///< row: {"evicted": id}
  ExportConfigurations,  ///< begins a job; row: Job. Rows of the job: lines of CSV
  ExportPaths,           ///< rows: lines of an experience file; filters robot and task
  RetirePath,            ///< row: Retirement
  ResetTask,             ///< row: Retirement
  Backup,                ///< begins a job that writes a file at the server; row: Job
  ListJobs,              ///< rows: Job
  ShowJob,               ///< row: Job, when the job has ended or `deadline` has passed
  CancelJob,             ///< row: Job
  JobRows,               ///< the rows of a done job, page by page
  ListAttempts,          ///< rows: AttemptSummary, in the order of arrival; filters robot and task
  RenameRobot,           ///< `robot` gets the label `argument`; row: RobotSummary
  RemoveRobot,           ///< row: RobotRemoval
  ListAudit,             ///< rows: AuditEntry, the newest first; of the name `argument`, if any
  ListClients,           ///< rows: ClientUse, the busiest first
  ListBackups,           ///< rows: BackupSummary, the newest first
  HashBackup,            ///< begins a job; row: Job. Rows of the job: SHA-256 in hex, bytes
  ReadBackup,            ///< row: bytes of a backup from `cursor` on, in base64
  FindAttempts,          ///< rows: AttemptSummary as AttemptFilter says; filters robot and task
  ListMeshes,            ///< rows: StoredMesh, the contents of a robot's meshes that are here
  RestorePath,           ///< of `argument`, or of robot and task as filters; row: Restoration
  RenameTask,            ///< `task` gets the name `argument`; row: TaskSummary
  RemoveTask             ///< row: TaskRemoval
};
inline constexpr AdminVerb kLastVerb = AdminVerb::RemoveTask;

/// Kind of object that `argument` of a request names, where a narrowed certificate or the owner of
/// a job limits it.
enum class VerbArgument { Other, Robot, Task, Report, Distribution, Job };

struct VerbRule {
  enum Trait : unsigned {
    Changes = 1,     ///< logged in the audit log; without security by place or token
    OfAll = 2,       ///< about all tasks and robots: not for a certificate limited to some of them
    Lists = 4,       ///< a page may have fewer rows than requested
    NamesRobot = 8,  ///< its request may name a robot, beside `argument`
    NamesTask = 16,  ///< its request may name a task, beside `argument`
    Filters = NamesRobot | NamesTask,
    FromMemory = 32,  ///< answered without the store
    Long = 64         ///< takes many transactions; in the audit log as begun before the first
  };

  AdminVerb verb;
  std::string_view name;  ///< in the audit log, so it never changes
  std::string_view act;   ///< completes "... may not <act>"
  AccessRole least;       ///< this role, and those after it in AccessRole
  VerbArgument argument;
  unsigned traits = 0;

  constexpr bool is(Trait trait) const { return (traits & trait) == trait; }
};

/// One for each verb, in the order of AdminVerb.
inline constexpr auto kVerbRules = [] {
  using enum AdminVerb;
  using enum VerbRule::Trait;
  using Is = VerbArgument;
  constexpr AccessRole kRobot = AccessRole::Robot, kReader = AccessRole::Reader,
                       kOperator = AccessRole::Operator, kAdmin = AccessRole::Admin;
  return std::array{
      VerbRule{Status, "status", "see the status", kRobot, Is::Other},
      VerbRule{ListRobots, "list_robots", "list robots", kReader, Is::Other, Lists},
      VerbRule{ShowRobot, "show_robot", "see a robot's description", kReader, Is::Robot},
      VerbRule{ListTasks, "list_tasks", "list tasks", kReader, Is::Other, Lists},
      VerbRule{ShowTask, "show_task", "see a task", kReader, Is::Task},
      VerbRule{ListPaths, "list_paths", "list paths", kReader, Is::Other, Lists | Filters},
      VerbRule{ShowPath, "show_path", "see a path", kReader, Is::Report},
      VerbRule{ListDistributions, "list_distributions", "list distributions", kReader, Is::Other,
               Lists | Filters},
      VerbRule{ShowDistribution, "show_distribution", "see a distribution", kReader,
               Is::Distribution},
      VerbRule{ExplainDistribution, "explain_distribution", "have a distribution explained",
               kReader, Is::Distribution},
      VerbRule{EvictDistribution, "evict_distribution", "evict distributions", kOperator,
               Is::Distribution, Changes},
      VerbRule{ExportConfigurations, "export_configurations", "export configurations", kReader,
               Is::Distribution},
      VerbRule{ExportPaths, "export_paths", "export paths", kReader, Is::Other, Lists | Filters},
      VerbRule{RetirePath, "retire_path", "retire paths", kOperator, Is::Report, Changes},
      VerbRule{ResetTask, "reset_task", "reset tasks", kOperator, Is::Task, Changes | Long},
      VerbRule{Backup, "backup", "make backups", kOperator, Is::Other, Changes | OfAll},
      VerbRule{ListJobs, "list_jobs", "list jobs", kOperator, Is::Other,
               OfAll | Lists | FromMemory},
      VerbRule{ShowJob, "show_job", "see a job", kReader, Is::Job},
      // Of the caller's own job; of others see access.hpp.
      VerbRule{CancelJob, "cancel_job", "cancel jobs", kReader, Is::Job, Changes},
      VerbRule{JobRows, "job_rows", "read what a job made", kReader, Is::Job, FromMemory},
      VerbRule{ListAttempts, "list_attempts", "list attempts", kReader, Is::Other, Lists | Filters},
      VerbRule{RenameRobot, "rename_robot", "rename robots", kAdmin, Is::Robot,
               Changes | NamesRobot},
      VerbRule{RemoveRobot, "remove_robot", "remove robots", kAdmin, Is::Robot, Changes | Long},
      VerbRule{ListAudit, "list_audit", "read the audit log", kOperator, Is::Other, OfAll | Lists},
      VerbRule{ListClients, "list_clients", "list clients", kOperator, Is::Other,
               OfAll | Lists | FromMemory},
      VerbRule{ListBackups, "list_backups", "list backups", kOperator, Is::Other, OfAll | Lists},
      // A copy of everything leaves the server: in the audit log once, and without security for its
      // own machine alone. Reading the pieces of one is in the log where it is refused.
      VerbRule{HashBackup, "hash_backup", "digest backups", kOperator, Is::Other, Changes | OfAll},
      VerbRule{ReadBackup, "read_backup", "download backups", kOperator, Is::Other,
               Changes | OfAll},
      VerbRule{FindAttempts, "find_attempts", "find attempts", kReader, Is::Other, Lists | Filters},
      VerbRule{ListMeshes, "list_meshes", "see a robot's meshes", kReader, Is::Robot, Lists},
      VerbRule{RestorePath, "restore_path", "restore paths", kOperator, Is::Report,
               Changes | Filters | Long},
      VerbRule{RenameTask, "rename_task", "rename tasks", kAdmin, Is::Task, Changes | NamesTask},
      VerbRule{RemoveTask, "remove_task", "remove tasks", kAdmin, Is::Task, Changes | Long}};
}();

/// Whether a table has one row for each verb, in their order.
/// \param table  of rows with a member `verb`.
template <typename Table>
constexpr bool is_complete_for_verbs(const Table& table) {
  std::size_t verb = 0;
  for (const auto& row : table)
    if (static_cast<std::size_t>(row.verb) != verb++)
      return false;
  return verb == static_cast<std::size_t>(kLastVerb) + 1;
}
static_assert(is_complete_for_verbs(kVerbRules));

constexpr const VerbRule& rule_of(AdminVerb verb) {
  return kVerbRules.at(static_cast<std::size_t>(verb));
}

}  // namespace kinship
