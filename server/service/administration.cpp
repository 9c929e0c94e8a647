#include "server/service/administration.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "proto/types/limits.hpp"
#include "robots/inverse/inverse.hpp"
#include "server/access/verb_rules.hpp"
#include "server/catalog/freshness.hpp"
#include "server/service/backup_verbs.hpp"
#include "server/service/explain_distribution.hpp"
#include "server/service/export_paths.hpp"
#include "server/service/find_by_name.hpp"
#include "server/service/job_verbs.hpp"
#include "server/service/narrowing.hpp"

namespace kinship::service {
namespace {

void allow_no_filter(const AdminRequest& request) {
  if (!request.robot.empty() || !request.task.empty())
    throw Failure(ErrorCode::InvalidInput, "this list has no filters");
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
  if (!access::rule_of(request.verb).is_change)
    return attempt(request, request_key, caller, audit);
  if (std::optional<AdminPage> before = answered_.find(request_key))
    return std::move(*before);
  AdminPage page = attempt(request, request_key, caller, audit);
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

AdminPage Administration::attempt(const AdminRequest& request, const std::string& request_key,
                                  const Caller& caller, const AuditEntry& audit) {
  try {
    const Narrowing narrowing(parts_.store, caller);
    narrowing.check(request);
    AdminPage page = dispatch(request, request_key, audit);
    narrowing.apply(page);
    return page;
  } catch (const Failure& failure) {
    return page_of(failure.error());
  } catch (const std::exception& exception) {
    return page_of(Error{ErrorCode::Internal, exception.what()});
  }
}

AdminPage Administration::dispatch(const AdminRequest& request, const std::string& request_key,
                                   const AuditEntry& audit) {
  if (std::optional<Job> begun = parts_.jobs.begun_by(request_key))
    return page_of(std::move(*begun));
  switch (request.verb) {
    case AdminVerb::Status:
      return page_of(parts_.status());
    case AdminVerb::ListRobots:
      return list_robots(request);
    case AdminVerb::ShowRobot:
      return show_robot(request.argument);
    case AdminVerb::ListTasks:
      allow_no_filter(request);
      return page_of(parts_.store.list_tasks(request.cursor, page_size(request)));
    case AdminVerb::ShowTask:
      return show_task(request.argument);
    case AdminVerb::ListPaths:
      return list_paths(request);
    case AdminVerb::ShowPath:
      return show_path(request.argument);
    case AdminVerb::ListDistributions:
      return list_distributions(request);
    case AdminVerb::ShowDistribution:
      return show_distribution(request.argument);
    case AdminVerb::ExplainDistribution:
      return explain(request.argument);
    case AdminVerb::ExportConfigurations:
      return export_configurations(request.argument, request_key, audit);
    case AdminVerb::EvictDistribution:
      return evict_distribution(request.argument, audit);
    case AdminVerb::ExportPaths:
      return export_paths(request);
    case AdminVerb::RetirePath:
      return retire_path(request.argument, audit);
    case AdminVerb::ResetTask:
      return reset_task(request.argument, audit);
    case AdminVerb::RenameRobot:
      return rename_robot(request, audit);
    case AdminVerb::RemoveRobot:
      return remove_robot(request.argument, audit);
    case AdminVerb::ListAttempts:
      return list_attempts(request);
    case AdminVerb::ListClients:
      return list_clients(request);
    case AdminVerb::ListAudit:
      return page_of(parts_.store.list_audit(request.argument, request.cursor, page_size(request)));
    default:
      return dispatch_jobs(request, request_key, audit);
  }
}

/// The verbs about jobs and backups.
AdminPage Administration::dispatch_jobs(const AdminRequest& request, const std::string& request_key,
                                        const AuditEntry& audit) {
  switch (request.verb) {
    case AdminVerb::Backup:
      return back_up(request.argument, request_key, audit);
    case AdminVerb::ListJobs:
      return list_jobs(parts_.jobs, request);
    case AdminVerb::ShowJob:
      return page_of(parts_.jobs.find(request.argument));
    case AdminVerb::CancelJob:
      return cancel_job(request.argument, audit);
    case AdminVerb::JobRows:
      return job_rows(parts_.jobs, request);
    case AdminVerb::ListBackups:
      return list_backups(parts_.store, parts_.backups, request);
    case AdminVerb::HashBackup:
      return hash_backup(request.argument, request_key, audit);
    case AdminVerb::ReadBackup:
      return read_backup(request, audit);
    default:
      return page_of(Error{ErrorCode::InvalidInput, "this server does not know the verb"});
  }
}

AdminPage Administration::list_robots(const AdminRequest& request) {
  allow_no_filter(request);
  store::Page<RobotSummary> page = parts_.store.list_robots(request.cursor, page_size(request));
  for (RobotSummary& summary : page.rows)
    name_solver(summary);
  return page_of(std::move(page));
}

AdminPage Administration::list_clients(const AdminRequest& request) {
  allow_no_filter(request);
  const Result<std::size_t> first = row_number(request.cursor);
  return first ? page_of(parts_.clients(), *first, page_size(request)) : page_of(first.error());
}

AdminPage Administration::list_paths(const AdminRequest& request) {
  const std::optional<Digest> robot = robot_filter(request);
  check_task_filter(request);
  return page_of(parts_.store.list_paths(robot, request.task, request.cursor, page_size(request)));
}

AdminPage Administration::list_attempts(const AdminRequest& request) {
  const std::optional<Digest> robot = robot_filter(request);
  check_task_filter(request);
  return page_of(
      parts_.store.list_attempts(robot, request.task, request.cursor, page_size(request)));
}

AdminPage Administration::list_distributions(const AdminRequest& request) {
  const std::optional<Digest> robot = robot_filter(request);
  check_task_filter(request);
  store::Page<DistributionSummary> page =
      parts_.store.list_distributions(robot, request.task, request.cursor, page_size(request));
  complete_summaries(parts_.store, page.rows);
  return page_of(std::move(page));
}

AdminPage Administration::show_robot(const std::string& name) {
  RobotSummary summary = find_robot(parts_.store, name).value_or_throw();
  std::optional<store::RobotRecord> record = parts_.store.find_robot(summary.robot);
  if (!record)
    return page_of(not_found("robot", name));
  name_solver(summary);
  AdminPage page = page_of(std::move(summary));
  page.rows.emplace_back(std::move(record->description));
  return page;
}

AdminPage Administration::show_task(const std::string& task) {
  std::optional<TaskSummary> summary = parts_.store.find_task(task);
  return summary ? page_of(std::move(*summary)) : page_of(not_found("task", task));
}

AdminPage Administration::show_path(const std::string& uuid) {
  std::optional<Attempt> attempt = parts_.store.find_attempt(report_of(uuid));
  return attempt ? page_of(std::move(*attempt)) : page_of(not_found("report", uuid));
}

AdminPage Administration::show_distribution(const std::string& prefix) {
  Distribution distribution = find_distribution(prefix);
  if (catalog::is_retired(distribution, parts_.store.experience(distribution.task)))
    distribution.reason = cut_text(
        std::string(kNotServed) + (distribution.reason.empty() ? "" : "; ") + distribution.reason,
        kMaxMessageBytes);
  return page_of(std::move(distribution));
}

AdminPage Administration::explain(const std::string& prefix) {
  Distribution distribution = find_distribution(prefix);
  if (parts_.advise && has_mixture(distribution.state))
    distribution.advice = parts_.advise(distribution);
  Explanation explanation =
      explain_distribution(parts_.store, std::move(distribution), parts_.clock.unix_ms());
  if (const std::string trouble = parts_.fit_trouble(explanation.distribution.id); !trouble.empty())
    explanation.next_fit += "; " + trouble;
  if (const std::shared_ptr<const Rehearsal> known = parts_.rehearsal(explanation.distribution.id))
    explanation.rehearsal = *known;
  return page_of(std::move(explanation));
}

AdminPage Administration::export_paths(const AdminRequest& request) {
  const std::optional<Digest> robot = robot_filter(request);
  check_task_filter(request);
  return service::export_paths(parts_.store, robot, request);
}

std::optional<Digest> Administration::robot_filter(const AdminRequest& request) const {
  if (request.robot.empty())
    return std::nullopt;
  return find_robot(parts_.store, request.robot).value_or_throw().robot;
}

void Administration::check_task_filter(const AdminRequest& request) const {
  if (!request.task.empty() && !parts_.store.find_task(request.task))
    throw Failure(not_found("task", request.task));
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
