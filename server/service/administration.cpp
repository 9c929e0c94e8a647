#include "server/service/administration.hpp"

#include <algorithm>
#include <optional>
#include <utility>

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
  const bool names_robot = !request.robot.empty() && request.verb != AdminVerb::RenameRobot;
  if (!rule.is(VerbRule::Filters) && (names_robot || !request.task.empty()))
    throw Failure(ErrorCode::InvalidInput,
                  std::string(rule.name) + " takes no filter of robot or task");
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
  const AuditEntry audit = audit_entry(caller, request);
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

AdminPage Administration::refuse(const AdminRequest& request, const Caller& caller,
                                 const Error& refusal) {
  AdminPage page = page_of(refusal);
  trail_.not_done(audit_entry(caller, request), page);
  return page;
}

const std::array<Administration::VerbHandler, kVerbRules.size()> Administration::kHandlers = [] {
  using enum AdminVerb;
  using A = Administration;
  constexpr std::array kAll = {VerbHandler{Status, &A::show_status},
                               VerbHandler{ListRobots, &A::list_robots},
                               VerbHandler{ShowRobot, &A::show_robot},
                               VerbHandler{ListTasks, &A::list_tasks},
                               VerbHandler{ShowTask, &A::show_task},
                               VerbHandler{ListPaths, &A::list_paths},
                               VerbHandler{ShowPath, &A::show_path},
                               VerbHandler{ListDistributions, &A::list_distributions},
                               VerbHandler{ShowDistribution, &A::show_distribution},
                               VerbHandler{ExplainDistribution, &A::explain_distribution},
                               VerbHandler{EvictDistribution, &A::evict_distribution},
                               VerbHandler{ExportConfigurations, &A::export_configurations},
                               VerbHandler{ExportPaths, &A::export_paths},
                               VerbHandler{RetirePath, &A::retire_path},
                               VerbHandler{ResetTask, &A::reset_task},
                               VerbHandler{Backup, &A::back_up},
                               VerbHandler{ListJobs, &A::list_jobs},
                               VerbHandler{ShowJob, &A::show_job},
                               VerbHandler{CancelJob, &A::cancel_job},
                               VerbHandler{JobRows, &A::job_rows},
                               VerbHandler{ListAttempts, &A::list_attempts},
                               VerbHandler{RenameRobot, &A::rename_robot},
                               VerbHandler{RemoveRobot, &A::remove_robot},
                               VerbHandler{ListAudit, &A::list_audit},
                               VerbHandler{ListClients, &A::list_clients},
                               VerbHandler{ListBackups, &A::list_backups},
                               VerbHandler{HashBackup, &A::hash_backup},
                               VerbHandler{ReadBackup, &A::read_backup}};
  static_assert(is_complete_for_verbs(kAll));
  return kAll;
}();

AdminPage Administration::attempt(const Call& call, const Caller& caller) {
  try {
    check_filters(call.request);
    const Narrowing narrowing(parts_.store, caller);
    narrowing.check(call.request);
    AdminPage page = dispatch(call);
    narrowing.apply(page);
    return page;
  } catch (const Failure& failure) {
    return page_of(failure.error());
  } catch (const std::exception& exception) {
    return page_of(Error{ErrorCode::Internal, exception.what()});
  }
}

AdminPage Administration::dispatch(const Call& call) {
  if (std::optional<Job> begun = parts_.jobs.begun_by(call.key))
    return page_of(std::move(*begun));
  return (this->*kHandlers.at(static_cast<std::size_t>(call.request.verb)).handle)(call);
}

AdminPage Administration::show_status(const Call& /*call*/) { return page_of(parts_.status()); }

AdminPage Administration::list_robots(const Call& call) {
  store::Page<RobotSummary> page =
      parts_.store.list_robots(call.request.cursor, page_size(call.request));
  for (RobotSummary& summary : page.rows)
    name_solver(summary);
  return page_of(std::move(page));
}

AdminPage Administration::list_clients(const Call& call) {
  const Result<std::size_t> first = row_number(call.request.cursor);
  return first ? page_of(parts_.clients(), *first, page_size(call.request))
               : page_of(first.error());
}

AdminPage Administration::list_paths(const Call& call) {
  const AdminRequest& request = call.request;
  const std::optional<Digest> robot = robot_filter(request);
  return page_of(parts_.store.list_paths(robot, request.task, request.cursor, page_size(request)));
}

AdminPage Administration::list_attempts(const Call& call) {
  const AdminRequest& request = call.request;
  const std::optional<Digest> robot = robot_filter(request);
  return page_of(
      parts_.store.list_attempts(robot, request.task, request.cursor, page_size(request)));
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

AdminPage Administration::list_tasks(const Call& call) {
  return page_of(parts_.store.list_tasks(call.request.cursor, page_size(call.request)));
}

AdminPage Administration::show_task(const Call& call) {
  const std::string& task = call.request.argument;
  std::optional<TaskSummary> summary = parts_.store.find_task(task);
  return summary ? page_of(std::move(*summary)) : page_of(not_found("task", task));
}

AdminPage Administration::show_path(const Call& call) {
  const std::string& uuid = call.request.argument;
  std::optional<Attempt> attempt = parts_.store.find_attempt(report_of(uuid));
  return attempt ? page_of(std::move(*attempt)) : page_of(not_found("report", uuid));
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

AdminPage Administration::export_paths(const Call& call) {
  return service::export_paths(parts_.store, robot_filter(call.request), call.request);
}

AdminPage Administration::list_audit(const Call& call) {
  const AdminRequest& request = call.request;
  return page_of(parts_.store.list_audit(request.argument, request.cursor, page_size(request)));
}

std::optional<Digest> Administration::robot_filter(const AdminRequest& request) const {
  std::optional<Digest> robot;
  if (!request.robot.empty())
    robot = find_robot(parts_.store, request.robot).value_or_throw().robot;
  if (!request.task.empty() && !parts_.store.find_task(request.task))
    throw Failure(not_found("task", request.task));
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
}

}  // namespace kinship::service
