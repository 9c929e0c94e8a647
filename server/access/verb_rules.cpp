#include "server/access/verb_rules.hpp"

#include <array>
#include <cstddef>

namespace kinship::access {
namespace {

using enum AdminVerb;
using enum AccessRole;

constexpr bool kChanges = true, kReads = false, kOfAll = true;

constexpr std::array kRules = {
    VerbRule{Status, "status", "see the status", Robot, kReads},
    VerbRule{ListRobots, "list_robots", "list robots", Reader, kReads},
    VerbRule{ShowRobot, "show_robot", "see a robot's description", Reader, kReads},
    VerbRule{ListTasks, "list_tasks", "list tasks", Reader, kReads},
    VerbRule{ShowTask, "show_task", "see a task", Reader, kReads},
    VerbRule{ListPaths, "list_paths", "list paths", Reader, kReads},
    VerbRule{ShowPath, "show_path", "see a path", Reader, kReads},
    VerbRule{ListDistributions, "list_distributions", "list distributions", Reader, kReads},
    VerbRule{ShowDistribution, "show_distribution", "see a distribution", Reader, kReads},
    VerbRule{ExplainDistribution, "explain_distribution", "have a distribution explained", Reader,
             kReads},
    VerbRule{EvictDistribution, "evict_distribution", "evict distributions", Operator, kChanges},
    VerbRule{ExportConfigurations, "export_configurations", "export configurations", Reader,
             kReads},
    VerbRule{ExportPaths, "export_paths", "export paths", Reader, kReads},
    VerbRule{RetirePath, "retire_path", "retire paths", Operator, kChanges},
    VerbRule{ResetTask, "reset_task", "reset tasks", Operator, kChanges},
    VerbRule{Backup, "backup", "make backups", Operator, kChanges, kOfAll},
    VerbRule{ListJobs, "list_jobs", "list jobs", Operator, kReads, kOfAll},
    VerbRule{ShowJob, "show_job", "see a job", Reader, kReads},
    // Of a job of one's own; of others see access.hpp.
    VerbRule{CancelJob, "cancel_job", "cancel jobs", Reader, kChanges},
    VerbRule{JobRows, "job_rows", "read what a job made", Reader, kReads},
    VerbRule{ListAttempts, "list_attempts", "list attempts", Reader, kReads},
    VerbRule{RenameRobot, "rename_robot", "rename robots", Admin, kChanges},
    VerbRule{RemoveRobot, "remove_robot", "remove robots", Admin, kChanges},
    VerbRule{ListAudit, "list_audit", "read the audit log", Operator, kReads, kOfAll},
    VerbRule{ListClients, "list_clients", "list clients", Operator, kReads, kOfAll},
    VerbRule{ListBackups, "list_backups", "list backups", Operator, kReads, kOfAll},
    // A copy of everything leaves the server: in the audit log once, and, without security, only
    // for its own machine. Reading the pieces of one is in it where it is refused.
    VerbRule{HashBackup, "hash_backup", "digest backups", Operator, kChanges, kOfAll},
    VerbRule{ReadBackup, "read_backup", "download backups", Operator, kChanges, kOfAll}};

constexpr bool is_complete() {
  if (kRules.size() != static_cast<std::size_t>(kLastVerb) + 1)
    return false;
  for (std::size_t i = 0; i < kRules.size(); ++i)
    if (static_cast<std::size_t>(kRules[i].verb) != i)
      return false;
  return true;
}
static_assert(is_complete(), "each verb of AdminVerb has its rule, in their order");

}  // namespace

std::span<const VerbRule> verb_rules() { return kRules; }

const VerbRule& rule_of(AdminVerb verb) { return kRules.at(static_cast<std::size_t>(verb)); }

}  // namespace kinship::access
