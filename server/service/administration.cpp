#include "server/service/administration.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "proto/types/base64.hpp"
#include "proto/types/limits.hpp"
#include "robots/inverse/inverse.hpp"
#include "server/catalog/freshness.hpp"
#include "server/service/explain_distribution.hpp"
#include "server/service/export_paths.hpp"
#include "server/service/find_by_name.hpp"
#include "server/service/narrowing.hpp"

namespace kinship::service {
namespace {

/// \throws Failure(InvalidInput) for filters that the verb would not obey.
void check_filters(const AdminRequest& request) {
  const VerbRule& rule = rule_of(request.verb);
  const auto refuse = [&](const char* filter) {
    throw Failure(ErrorCode::InvalidInput,
                  std::string(rule.name) + " takes no filter of " + filter);
  };
  if (!request.robot.empty() && !rule.is(VerbRule::NamesRobot))
    refuse("robot");
  if (!request.task.empty() && !rule.is(VerbRule::NamesTask))
    refuse("task");
}

/// Jobs that were begun are known by themselves, as they stand; and pieces of a backup, which
/// change nothing, can be read again.
bool is_kept(AdminVerb verb, const AdminPage& page) {
  const bool is_begun_job = verb != AdminVerb::CancelJob && !page.rows.empty() &&
                            std::holds_alternative<Job>(page.rows.front());
  return verb != AdminVerb::ReadBackup && !is_begun_job;
}

}  // namespace

AdminPage Administration::answer(const AdminRequest& request, const std::string& request_key,
                                 const Caller& caller) {
  const AuditEntry audit = audit_entry(caller, with_whole_uuid(request));
  const Call call{request, request_key, audit};
  if (!rule_of(request.verb).is(VerbRule::Changes))
    return attempt(call, caller);
  if (std::optional<AdminPage> before = answered_.find(request_key))
    return std::move(*before);
  AdminPage page = attempt(call, caller);
  trail_.not_done(audit, page);
  if (is_kept(request.verb, page))
    answered_.keep(request_key, page);
  return page;
}

/// The request of a change with the UUID that a prefix stands for, for the audit log.
AdminRequest Administration::with_whole_uuid(AdminRequest request) const {
  const VerbRule& rule = rule_of(request.verb);
  if (rule.is(VerbRule::Changes) && rule.argument == VerbArgument::Report &&
      !request.argument.empty() && !Uuid::parse(request.argument))
    try {
      request.argument = report_of(parts_.store, request.argument).text();
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): it is refused as it stands
    }
  return request;
}

AdminPage Administration::refuse(const AdminRequest& request, const Caller& caller,
                                 const Error& refusal) {
  AdminPage page = page_of(refusal);
  trail_.not_done(audit_entry(caller, request), page);
  return page;
}

const std::array<Administration::VerbHandler, kVerbRules.size()> Administration::kHandlers = [] {
  using enum AdminVerb;
  using A = Administration;
  constexpr auto kAll = std::to_array<VerbHandler>({
      {Status, [](A& self, const Call&) { return page_of(self.parts_.status()); }},
      {ListRobots, &run<&A::list_robots>},
      {ShowRobot, &run<&A::show_robot>},
      {ListTasks, &list<&store::Store::list_tasks>},
      {ShowTask, &run<&A::show_task>},
      {ListPaths, &list_filtered<&store::Store::list_paths>},
      {ShowPath, &run<&A::show_path>},
      {ListDistributions, &run<&A::list_distributions>},
      {ShowDistribution, &run<&A::show_distribution>},
      {ExplainDistribution, &run<&A::explain_distribution>},
      {EvictDistribution, &run<&A::evict_distribution>},
      {ExportConfigurations, &run<&A::export_configurations>},
      {ExportPaths,
       [](A& self, const Call& call) {
         return service::export_paths(self.parts_.store, self.robot_filter(call.request),
                                      call.request);
       }},
      {RetirePath, &run<&A::retire_path>},
      {ResetTask, &run<&A::reset_task>},
      {Backup, &run<&A::back_up>},
      {ListJobs,
       [](A& self, const Call& call) {
         return page_of(self.parts_.jobs.list(call.request.cursor, page_size(call.request)));
       }},
      // As it stands: Service waits for its end.
      {ShowJob,
       [](A& self, const Call& call) {
         return page_of(self.parts_.jobs.find(call.request.argument));
       }},
      {CancelJob, &run<&A::cancel_job>},
      {JobRows, &run<&A::job_rows>},
      {ListAttempts, &list_filtered<&store::Store::list_attempts>},
      {RenameRobot, &run<&A::rename_robot>},
      {RemoveRobot, &run<&A::remove_robot>},
      {ListAudit,
       [](A& self, const Call& call) {
         return page_of(self.parts_.store.list_audit(call.request.argument, call.request.cursor,
                                                     page_size(call.request)));
       }},
      {ListClients,
       [](A& self, const Call& call) { return page_of(self.parts_.clients(), call.request); }},
      {ListBackups, &run<&A::list_backups>},
      {HashBackup, &run<&A::hash_backup>},
      {ReadBackup, &run<&A::read_backup>},
      {FindAttempts, &run<&A::find_attempts>},
      {ListMeshes, &run<&A::list_meshes>},
      {RestorePath, &run<&A::restore_path>},
      {RenameTask, &run<&A::rename_task>},
      {RemoveTask, &run<&A::remove_task>},
  });
  static_assert(is_complete_for_verbs(kAll));
  return kAll;
}();

AdminPage Administration::attempt(const Call& call, const Caller& caller) {
  try {
    const Narrowing narrowing(parts_.store, caller);
    AdminPage page = checked(call, narrowing);
    narrowing.apply(page);  // of a refusal too: it may suggest names
    return page;
  } catch (const Failure& failure) {
    return page_of(failure.error());
  } catch (const std::exception& exception) {
    return page_of(Error{ErrorCode::Internal, exception.what()});
  }
}

AdminPage Administration::checked(const Call& call, const Narrowing& narrowing) {
  try {
    check_filters(call.request);
    narrowing.check(call.request);
    return dispatch(call);
  } catch (const Failure& failure) {
    return page_of(failure.error());
  }
}

AdminPage Administration::dispatch(const Call& call) {
  if (std::optional<Job> begun = parts_.jobs.begun_by(call.key))
    return page_of(std::move(*begun));
  return kHandlers.at(static_cast<std::size_t>(call.request.verb)).handle(*this, call);
}

AdminPage Administration::list_robots(const Call& call) {
  store::Page<RobotSummary> page =
      parts_.store.list_robots(call.request.cursor, page_size(call.request));
  for (RobotSummary& summary : page.rows)
    name_solver(summary);
  return page_of(std::move(page));
}

AdminPage Administration::list_distributions(const Call& call) {
  const AdminRequest& request = call.request;
  const std::optional<Digest> robot = robot_filter(request);
  store::Page<DistributionSummary> page =
      parts_.store.list_distributions(robot, request.task, request.cursor, page_size(request));
  complete_summaries(parts_.store, page.rows);
  return page_of(std::move(page));
}

AdminPage Administration::show_robot(const Call& call) {
  const std::string& name = call.request.argument;
  RobotSummary summary = find_robot(parts_.store, name).value_or_throw();
  std::optional<store::RobotRecord> record = parts_.store.find_robot(summary.robot);
  if (!record)
    return page_of(not_found("robot", name));
  name_solver(summary);
  AdminPage page = page_of(std::move(summary));
  page.rows.emplace_back(std::move(record->description));
  return page;
}

AdminPage Administration::list_meshes(const Call& call) {
  const std::string& name = call.request.argument;
  const Digest robot = find_robot(parts_.store, name).value_or_throw().robot;
  const std::optional<store::RobotRecord> record = parts_.store.find_robot(robot);
  if (!record)
    return page_of(not_found("robot", name));
  std::set<Digest> contents;
  for (const LinkMesh& mesh : record->description.meshes)
    contents.insert(mesh.content);
  const std::vector<Digest> all(contents.begin(), contents.end());
  AdminPage page;
  page.status = AdminStatus::Ok;
  std::size_t next = row_number(call.request.cursor).value_or_throw();
  for (; next < all.size() && page.rows.size() < page_size(call.request); ++next)
    if (const std::optional<MeshContent> content = parts_.store.find_mesh(all[next]))
      page.rows.emplace_back(StoredMesh{all[next], content->bytes, to_base64(content->zlib)});
  if (next < all.size())
    page.next_cursor = std::to_string(next);
  return page;
}

AdminPage Administration::show_task(const Call& call) {
  const std::string& task = call.request.argument;
  std::optional<TaskSummary> summary = parts_.store.find_task(task);
  return summary ? page_of(std::move(*summary)) : page_of(no_task(parts_.store, task));
}

AdminPage Administration::show_path(const Call& call) {
  const std::string& uuid = call.request.argument;
  std::optional<Attempt> attempt = parts_.store.find_attempt(report_of(parts_.store, uuid));
  return attempt ? page_of(std::move(*attempt)) : page_of(not_found("report", uuid));
}

AdminPage Administration::find_attempts(const Call& call) {
  const AdminRequest& request = call.request;
  const AttemptFilter filter = attempt_filter_from_text(request.argument).value_or_throw();
  return page_of(parts_.store.find_attempts({robot_filter(request), request.task, filter},
                                            request.cursor, page_size(request)));
}

AdminPage Administration::show_distribution(const Call& call) {
  Distribution distribution = find_distribution(call.request.argument);
  if (catalog::is_retired(distribution, parts_.store.experience(distribution.task)))
    distribution.reason = cut_text(
        std::string(kNotServed) + (distribution.reason.empty() ? "" : "; ") + distribution.reason,
        kMaxMessageBytes);
  return page_of(std::move(distribution));
}

AdminPage Administration::explain_distribution(const Call& call) {
  Distribution distribution = find_distribution(call.request.argument);
  if (has_mixture(distribution.state))
    distribution.advice = parts_.guidance.advise(distribution);
  Explanation explanation =
      service::explain_distribution(parts_.store, std::move(distribution), parts_.clock.unix_ms());
  if (const std::string trouble = parts_.guidance.trouble_of(explanation.distribution.id);
      !trouble.empty())
    explanation.next_fit += "; " + trouble;
  if (const std::shared_ptr<const Rehearsal> known =
          parts_.guidance.find_rehearsal(explanation.distribution.id))
    explanation.rehearsal = *known;
  return page_of(std::move(explanation));
}

std::optional<Digest> Administration::robot_filter(const AdminRequest& request) const {
  std::optional<Digest> robot;
  if (!request.robot.empty())
    robot = find_robot(parts_.store, request.robot).value_or_throw().robot;
  if (!request.task.empty() && !parts_.store.find_task(request.task))
    throw Failure(no_task(parts_.store, request.task));
  return robot;
}

Distribution Administration::find_distribution(const std::string& prefix) const {
  const Digest id = find_distribution_id(parts_.store, prefix).value_or_throw();
  std::optional<Distribution> distribution = parts_.store.find_distribution(id);
  if (!distribution)
    throw Failure(not_found("distribution", prefix));
  return std::move(*distribution);
}

void Administration::name_solver(RobotSummary& summary) {
  const Result<runtime::RobotRegistry::RobotPointer> robot = parts_.robots.find(summary.robot);
  summary.solver = robot ? inverse::solver_name(robot.value()->chain) : robot.error().message;
  if (robot)
    summary.geometry = robot.value()->geometry;
  if (robot)
    summary.meshes = runtime::describe_meshes(*robot.value());
}

}  // namespace kinship::service
