#include "server/store/sql_store.hpp"

#include "proto/types/names.hpp"
#include "server/store/tables/attempts.hpp"
#include "server/store/tables/audit.hpp"
#include "server/store/tables/distributions.hpp"
#include "server/store/tables/experience.hpp"
#include "server/store/tables/meshes.hpp"
#include "server/store/tables/rehearsals.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/tables/settings.hpp"
#include "server/store/tables/tasks.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store {

Result<RegisterStatus> SqlStore::register_robot(const RobotRecord& robot) {
  if (read(View::Snapshot, [&](Session& session) { return is_registered(session, robot.digest); }))
    return RegisterStatus::Known;
  Result<RegisterStatus> result =
      write([&](Session& session, const RetireSome&) { return insert_robot(session, robot); });
  if (damaged_robots_ > 0)
    static_cast<void>(robots());  // counts again: this may have been one of them
  return result;
}

bool SqlStore::replace_geometry(const RobotRecord& robot) {
  return write([&](Session& session, const RetireSome&) { return update_robot(session, robot); });
}

Result<bool> SqlStore::rename_robot(const Digest& robot, const std::string& label,
                                    const AuditEntry* audit) {
  if (const auto error = check_label(label))
    return *error;
  return write([&](Session& session, const RetireSome&) {
    return rename_audited(session, robot, label, audit);
  });
}

Result<RemovedRobot> SqlStore::remove_robot(const Digest& robot, const std::stop_token& stop,
                                            const AuditEntry* audit) {
  return remove_in_steps(robot, stop, [&](const RemovedRobot& removed) {
    return write([&](Session& session, const RetireSome& retire_some) {
      return continue_removal(session, robot, removed, retire_some, audit);
    });
  });
}

std::map<Digest, std::uint64_t> SqlStore::geometry_revisions() const {
  return read(View::EachStatement, select_geometry_revisions);
}

std::optional<RobotRecord> SqlStore::find_robot(const Digest& robot) const {
  return read(View::Snapshot, [&](Session& session) { return select_robot(session, robot); });
}

std::vector<RobotRecord> SqlStore::robots() const {
  RobotsRead found = read(View::Snapshot, select_robots);
  damaged_robots_ = found.damaged.size();
  return std::move(found.robots);
}

MeshesPut SqlStore::put_meshes(const Digest& robot, const std::vector<MeshContent>& contents,
                               const MeshLimits& limits) {
  const ReadMeshes read(contents);
  return write([&](Session& session, const RetireSome&) {
    return insert_meshes(session, robot, read, limits);
  });
}

std::optional<MeshContent> SqlStore::find_mesh(const Digest& content) const {
  return read(View::EachStatement, [&](Session& session) { return select_mesh(session, content); });
}

std::map<Digest, std::uint64_t> SqlStore::known_meshes(const std::set<Digest>& contents) const {
  return read(View::EachStatement,
              [&](Session& session) { return select_known_meshes(session, contents); });
}

MeshUse SqlStore::mesh_use() const { return read(View::EachStatement, count_meshes); }

std::vector<ExperienceSummary> SqlStore::experience(std::string_view task) const {
  return read(View::EachStatement, [&](Session& session) { return experience_of(session, task); });
}

std::uint64_t SqlStore::generation(const Digest& robot, std::string_view task) const {
  return read(View::EachStatement,
              [&](Session& session) { return generation_of(session, robot, task); });
}

Page<AttemptSummary> SqlStore::find_attempts(const WantedAttempts& wanted, std::string_view cursor,
                                             std::size_t limit) const {
  return read(View::Snapshot, [&](Session& session) {
    return page_of_found_attempts(session, wanted, cursor, limit);
  });
}

AttemptTotals SqlStore::attempt_totals(const Digest& robot, std::string_view task) const {
  return read(View::Snapshot, [&](Session& session) { return totals_of(session, robot, task); });
}

Result<Retirement> SqlStore::reset_task(std::string_view task, const std::stop_token& stop,
                                        const AuditEntry* audit) {
  const Result<TaskReset> reset =
      write([&](Session& session, const RetireSome&) { return begin_reset(session, task, audit); });
  if (!reset)
    return reset.error();
  return reset_in_steps(task, stop, [&](const Retirement& retired) {
    return write([&](Session& session, const RetireSome& retire_some) {
      return continue_reset(session, *reset, retired, retire_some, audit);
    });
  });
}

Result<std::vector<Digest>> SqlStore::rename_task(std::string_view task, std::string_view name,
                                                  const AuditEntry* audit) {
  return write([&](Session& session, const RetireSome&) {
    return store::rename_task(session, task, name, audit);
  });
}

Result<RemovedTask> SqlStore::remove_task(std::string_view task, const std::stop_token& stop,
                                          const AuditEntry* audit) {
  TaskRemoval removal;
  removal.task = task;
  const Result<TaskReset> reset = write([&](Session& session, const RetireSome&) {
    Result<TaskReset> begun = begin_reset(session, task, audit);
    if (begun)  // a later attempt brings the task back
      removal.attempts = attempts_of_task(session, begun->task_id);
    return begun;
  });
  if (!reset)
    return reset.error();
  const Result<Retirement> retired = reset_in_steps(task, stop, [&](const Retirement& so_far) {
    return write([&](Session& session, const RetireSome& retire_some) {
      return continue_reset(session, *reset, so_far, retire_some, nullptr);
    });
  });
  if (!retired)
    return retired.error();
  removal.paths = retired->paths;
  return write([&](Session& session, const RetireSome&) {
    return end_task_removal(session, reset->task_id, removal, audit);
  });
}

std::vector<std::string> SqlStore::task_names(const WantedNames& wanted) const {
  return read(View::EachStatement,
              [&](Session& session) { return select_task_names(session, wanted); });
}

std::vector<Uuid> SqlStore::reports_between(const Uuid& first, const Uuid& last,
                                            std::size_t limit) const {
  return read(View::EachStatement, [&](Session& session) {
    std::vector<Uuid> reports;
    for (const Row& row : session.query(
             "SELECT report_uuid FROM attempt WHERE report_uuid >= $1 AND report_uuid <= $2 AND " +
                 session.is_intact("attempt") + " ORDER BY report_uuid LIMIT $3",
             first, last, limit))
      reports.push_back(id_of<Uuid>(row.column_blob(0)));
    return reports;
  });
}

std::uint64_t SqlStore::put_distribution(const Distribution& distribution, const FitRight& right) {
  return write([&](Session& session, const RetireSome&) {
    require_fit_right(session, distribution.id, right);
    return upsert_distribution(session, distribution, max_distribution_bytes_);
  });
}

std::optional<Distribution> SqlStore::find_distribution(const Digest& id) const {
  std::optional<Distribution> distribution = read(View::EachStatement, [&](Session& session) {
                                               return select_distribution(session, id);
                                             }).distribution;
  if (distribution)
    distribution->store_epoch = epoch();
  return distribution;
}

bool SqlStore::evict_distribution(const Digest& id, const AuditEntry* audit) {
  return write(
      [&](Session& session, const RetireSome&) { return evict_audited(session, id, audit); });
}

void SqlStore::put_rehearsal(const StoredRehearsal& rehearsal, const RehearsalLimits& limits) {
  run_writing([&](Session& session, const RetireSome&) { insert_rehearsal(session, rehearsal); });
  const auto surplus = read(View::EachStatement, [&](Session& session) {
    return find_surplus_rehearsals(session, limits);
  });
  for (const std::int64_t row : surplus)
    try {  // apart: a page that cannot be read fails its transaction
      run_writing([row](Session& session, const RetireSome&) { drop_rehearsal(session, row); });
    } catch (const Failure&) {  // the row stays, and the next rehearsal tries again
    }
}

std::vector<StoredRehearsal> SqlStore::read_rehearsals(std::size_t limit) const {
  return read(View::EachStatement,
              [&](Session& session) { return select_rehearsals(session, limit); });
}

void SqlStore::trim_searches_later() const {
  run_writing_later([this](Session& session, const RetireSome&) {
    if (trim_searches(session, search_room_.limits(), now_ms()))
      trim_searches_later();
  });
}

void SqlStore::add_audit(const AuditEntry& entry) {
  run_writing([&](Session& session, const RetireSome&) { insert_audit(session, entry); });
}

std::map<std::string, std::string> SqlStore::notes(std::string_view prefix) const {
  return read(View::EachStatement, [&](Session& session) { return select_notes(session, prefix); });
}

void SqlStore::put_notes(const std::map<std::string, std::optional<std::string>>& notes) {
  run_writing([&](Session& session, const RetireSome&) { write_notes(session, notes); });
}

Page<RobotSummary> SqlStore::list_robots(std::string_view cursor, std::size_t limit) const {
  return read(View::EachStatement,
              [&](Session& session) { return page_of_robots(session, cursor, limit); });
}

Page<TaskSummary> SqlStore::list_tasks(std::string_view cursor, std::size_t limit) const {
  return read(View::Snapshot,
              [&](Session& session) { return page_of_tasks(session, cursor, limit); });
}

std::optional<TaskSummary> SqlStore::find_task(std::string_view task) const {
  return read(View::Snapshot, [&](Session& session) { return summary_of_task(session, task); });
}

Page<AuditEntry> SqlStore::list_audit(std::string_view name, std::string_view cursor,
                                      std::size_t limit) const {
  return read(View::EachStatement,
              [&](Session& session) { return page_of_audit(session, name, cursor, limit); });
}

}  // namespace kinship::store
