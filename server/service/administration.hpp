#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"
#include "server/fitting/memory_ceiling.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/service/admin_page.hpp"
#include "server/service/answered_changes.hpp"
#include "server/service/audit_trail.hpp"
#include "server/service/backup_job.hpp"
#include "server/service/jobs.hpp"
#include "server/service/recent_downloads.hpp"
#include "server/service/served_guidance.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

class Narrowing;

/// Handles the requests of administrators. Robots are named by label or by a digest prefix of at
/// least four digits, paths by report UUID or at least eight digits of it, distributions by an id
/// prefix. May be shared between threads.
class Administration {
 public:
  /// References and functions; the objects behind them outlive this one.
  struct Parts {
    store::Store& store;
    runtime::RobotRegistry& robots;
    Jobs& jobs;
    const runtime::Clock& clock;
    ServedGuidance& guidance;
    std::function<ServerStatus()> status;
    fitting::MemoryCeiling* memory = nullptr;  ///< of all fits together; null: no limit
    /// Use of each client.
    std::function<std::vector<ClientUse>()> clients = [] { return std::vector<ClientUse>(); };
    BackupPlace backups = {};
    std::stop_token stop = {};  ///< ends a reset between two of its transactions
    /// Called after a change, with its task (may be empty) and its description.
    std::function<void(const std::string& task, const std::string& what)> on_change =
        [](const std::string&, const std::string&) {};
  };

  explicit Administration(Parts parts)
      : parts_(std::move(parts)), trail_(parts_.store, parts_.clock) {}

  /// Never throws: the page carries the error. ShowJob is answered with the job's current state.
  /// \param request_key  identifies the request; it begins with the caller's client, so other
  ///                     clients cannot forge it. A request sent again, e.g. after a lost reply,
  ///                     begins no second job and changes nothing a second time. Empty: it is never
  ///                     sent again.
  /// \param caller  its role was checked before (server/access); its limits to tasks and robots are
  ///                checked here.
  AdminPage answer(const AdminRequest& request, const std::string& request_key,
                   const Caller& caller);

  /// Writes a refused change to the audit log. \return the page with the refusal.
  AdminPage refuse(const AdminRequest& request, const Caller& caller, const Error& refusal);

 private:
  /// A request on its way to the handler of its verb.
  struct Call {
    const AdminRequest& request;
    const std::string& key;  ///< the request's key, see answer()
    const AuditEntry& audit;
  };
  using Handler = AdminPage (*)(Administration& self, const Call& call);
  struct VerbHandler {
    AdminVerb verb;
    Handler handle;
  };
  static const std::array<VerbHandler, kVerbRules.size()> kHandlers;
  template <AdminPage (Administration::*handle)(const Call& call)>
  static AdminPage run(Administration& self, const Call& call) {
    return (self.*handle)(call);
  }
  /// A listing of the store.
  template <auto read>
  static AdminPage list(Administration& self, const Call& call) {
    return page_of((self.parts_.store.*read)(call.request.cursor, page_size(call.request)));
  }
  /// A listing of the store that takes filters.
  template <auto read>
  static AdminPage list_filtered(Administration& self, const Call& call) {
    const AdminRequest& request = call.request;
    return page_of((self.parts_.store.*read)(self.robot_filter(request), request.task,
                                             request.cursor, page_size(request)));
  }

  AdminRequest with_whole_uuid(AdminRequest request) const;
  AdminPage attempt(const Call& call, const Caller& caller);
  AdminPage checked(const Call& call, const Narrowing& narrowing);
  AdminPage dispatch(const Call& call);

  // Each throws Failure(NotFound) for a missing object, and Failure(InvalidInput) for an invalid or
  // ambiguous name.
  AdminPage list_robots(const Call& call);
  AdminPage show_robot(const Call& call);
  AdminPage rename_robot(const Call& call);
  AdminPage remove_robot(const Call& call);
  AdminPage list_meshes(const Call& call);
  AdminPage show_task(const Call& call);
  AdminPage reset_task(const Call& call);
  AdminPage rename_task(const Call& call);
  AdminPage remove_task(const Call& call);
  AdminPage show_path(const Call& call);
  AdminPage retire_path(const Call& call);
  AdminPage restore_path(const Call& call);
  AdminPage list_distributions(const Call& call);
  AdminPage show_distribution(const Call& call);
  AdminPage explain_distribution(const Call& call);
  AdminPage export_configurations(const Call& call);
  AdminPage evict_distribution(const Call& call);
  AdminPage job_rows(const Call& call);
  AdminPage cancel_job(const Call& call);
  AdminPage back_up(const Call& call);
  AdminPage list_backups(const Call& call);
  AdminPage hash_backup(const Call& call);
  AdminPage read_backup(const Call& call);
  AdminPage find_attempts(const Call& call);

  /// \throws Failure(InvalidInput) for an invalid name; Failure(NotFound).
  BackupFile open_backup(const std::string& name) const;
  AdminPage begin_audited(Result<Jobs::Task> task, const AuditEntry& audit);
  AdminPage begin(Result<Jobs::Task> task, const AuditEntry& audit);
  /// The robot that a request's filters name. \throws Failure(NotFound), of its task as well.
  std::optional<Digest> robot_filter(const AdminRequest& request) const;
  std::vector<Uuid> reports_to_restore(const AdminRequest& request) const;
  Distribution find_distribution(const std::string& prefix) const;
  void forget_tasks_of(const Digest& robot);
  void drop_tasks(std::initializer_list<std::string> tasks,
                  const std::vector<Digest>& distributions);
  void for_each_task(const std::function<void(const TaskSummary&)>& take) const;
  void name_solver(RobotSummary& summary);
  AdminPage retired(Result<Retirement> retirement, const std::string& what);

  const Parts parts_;
  AuditTrail trail_;
  AnsweredChanges answered_;
  RecentDownloads downloads_;
};

}  // namespace kinship::service
