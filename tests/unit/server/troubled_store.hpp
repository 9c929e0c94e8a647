#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <new>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// Another program wrote to the robot's row behind the store's back.
inline void damage_robot(const std::filesystem::path& file, const std::string& label) {
  store::Database database(file, store::Access::ReadWrite);
  database.execute("UPDATE robot SET dof = dof + 1 WHERE label = '" + label + "'");
}

/// A store that has no memory left for reports (unless it is told to take them), and where
/// something may happen whenever paths were read or a task is reset, or which may have other
/// servers; else the real one.
class TroubledStore final : public store::Store {
 public:
  explicit TroubledStore(
      Store& store, std::function<void()> on_paths_read = [] {})
      : store_(store), on_paths_read_(std::move(on_paths_read)) {}

  bool takes_reports = false;
  std::atomic<std::size_t> commits = 0;  ///< of reports
  void commit_reports(std::vector<Attempt> attempts, ReportsDone done) override {
    ++commits;
    if (!takes_reports)
      throw std::bad_alloc();
    store_.commit_reports(std::move(attempts), std::move(done));
  }

  /// Called before and after each call of the exchange of stores; may throw, as when a line is cut
  /// before it carried a question, or an answer.
  mutable std::function<void()> on_exchange = [] {};
  store::Feed<store::ArrivedReport> list_arrivals(std::string_view task, std::string_view cursor,
                                                  std::size_t limit) const override {
    return exchange([&] { return store_.list_arrivals(task, cursor, limit); });
  }
  store::Feed<Uuid> list_retirements(std::string_view cursor, std::size_t limit) const override {
    return exchange([&] { return store_.list_retirements(cursor, limit); });
  }
  std::map<Uuid, Digest> known_reports(std::span<const Uuid> reports) const override {
    return exchange([&] { return store_.known_reports(reports); });
  }
  store::ReplicatedReports read_reports(std::span<const Uuid> reports,
                                        std::size_t max_bytes) const override {
    return exchange([&] { return store_.read_reports(reports, max_bytes); });
  }
  /// What commits what comes from another store; may never answer.
  std::function<void(std::vector<store::ReplicatedReport>, ReportsDone)> on_commit =
      [this](std::vector<store::ReplicatedReport> reports, ReportsDone done) {
        store_.commit_replicated(std::move(reports), std::move(done));
      };
  void commit_replicated(std::vector<store::ReplicatedReport> reports, ReportsDone done) override {
    exchange([&] {
      on_commit(std::move(reports), std::move(done));
      return true;
    });
  }
  std::optional<std::string> why_put_off(const Uuid& report) const override {
    return store_.why_put_off(report);
  }
  /// Called when reports of another store are to be retired.
  std::function<void(std::span<const Uuid>)> on_retire = [](std::span<const Uuid>) {};
  std::vector<Retirement> retire_reports(std::span<const Uuid> reports) override {
    on_retire(reports);
    return exchange([&] { return store_.retire_reports(reports); });
  }
  std::function<void()> on_stop_waiting = [] {};
  void stop_waiting() noexcept override { on_stop_waiting(); }
  std::map<std::string, std::string> notes(std::string_view prefix) const override {
    return store_.notes(prefix);
  }
  std::function<void()> on_notes = [] {};
  void put_notes(const std::map<std::string, std::optional<std::string>>& notes) override {
    on_notes();
    exchange([&] {
      store_.put_notes(notes);
      return true;
    });
  }

  bool has_others = false;  ///< servers
  bool is_shared() const override { return has_others; }
  /// What other servers did, and whether one of them fits; empty: there is no other one.
  std::function<std::optional<store::StoreChanges>(std::string_view cursor)> on_changes;
  std::optional<store::StoreChanges> changes_since(std::string_view cursor) const override {
    return on_changes ? on_changes(cursor) : store_.changes_since(cursor);
  }
  std::function<std::optional<store::FitRight>()> on_fit_right;
  std::optional<store::FitRight> take_fit_right(const Digest& id) override {
    return on_fit_right ? on_fit_right() : store_.take_fit_right(id);
  }
  /// Rights: of which, and the fence.
  std::vector<std::pair<Digest, std::uint64_t>> given_back() const {
    const std::lock_guard lock(given_back_mutex_);
    return given_back_;
  }
  void give_back_fit_right(const Digest& id, const store::FitRight& right) noexcept override {
    {
      const std::lock_guard lock(given_back_mutex_);
      given_back_.emplace_back(id, right.fence);
    }
    store_.give_back_fit_right(id, right);
  }

  Uuid epoch() const override { return store_.epoch(); }
  store::StorePoint point() const override { return store_.point(); }
  /// Called when a token is looked for in the store; may block.
  std::function<void()> on_lost = [] {};
  bool has_lost(const ConsistencyToken& token) const override {
    on_lost();
    return store_.has_lost(token);
  }
  bool may_have_lost(const ConsistencyToken& token) const override {
    return has_others || store_.may_have_lost(token);
  }
  bool begin_epoch_if_lost(const ConsistencyToken& token) override {
    return store_.begin_epoch_if_lost(token);
  }
  /// Called before the store tells its status; may block, and throw.
  std::function<void()> on_status = [] {};
  store::StoreStatus status() const override {
    on_status();
    return store_.status();
  }
  /// Called before a robot is registered; may throw.
  std::function<void()> on_register = [] {};
  Result<RegisterStatus> register_robot(const store::RobotRecord& robot) override {
    on_register();
    return store_.register_robot(robot);
  }
  /// Called when better geometry of a robot is written, before whoever writes it goes on.
  std::function<void()> on_geometry = [] {};
  bool replace_geometry(const store::RobotRecord& robot) override {
    const bool is_replaced = store_.replace_geometry(robot);
    on_geometry();
    return is_replaced;
  }
  Result<bool> rename_robot(const Digest& robot, const std::string& label,
                            const AuditEntry* audit) override {
    return store_.rename_robot(robot, label, audit);
  }
  Result<store::RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop,
                                           const AuditEntry* audit) override {
    return store_.remove_robot(robot, stop, audit);
  }
  std::map<Digest, std::uint64_t> geometry_revisions() const override {
    return store_.geometry_revisions();
  }
  /// Called before a robot is read; may throw.
  std::function<void()> on_robot_read = [] {};
  std::optional<store::RobotRecord> find_robot(const Digest& robot) const override {
    on_robot_read();
    return store_.find_robot(robot);
  }
  mutable std::atomic<int> descriptions_read = 0;  ///< how often all of them were
  std::vector<store::RobotRecord> robots() const override {
    ++descriptions_read;
    return store_.robots();
  }
  store::MeshesPut put_meshes(const Digest& robot, const std::vector<MeshContent>& contents,
                              const store::MeshLimits& limits) override {
    return store_.put_meshes(robot, contents, limits);
  }
  std::optional<MeshContent> find_mesh(const Digest& content) const override {
    return store_.find_mesh(content);
  }
  std::map<Digest, std::uint64_t> known_meshes(const std::set<Digest>& contents) const override {
    return store_.known_meshes(contents);
  }
  store::MeshUse mesh_use() const override { return store_.mesh_use(); }
  std::vector<store::ExperienceSummary> experience(std::string_view task) const override {
    return store_.experience(task);
  }
  std::uint64_t generation(const Digest& robot, std::string_view task) const override {
    return store_.generation(robot, task);
  }
  std::vector<store::StoredPath> read_paths(const Digest& robot, std::string_view task,
                                            const store::PathRange& range) const override {
    std::vector<store::StoredPath> paths = store_.read_paths(robot, task, range);
    on_paths_read_();
    return paths;
  }
  std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                     std::uint64_t generation) const override {
    return store_.path_ids(robot, task, generation);
  }
  std::optional<RecordedScene> read_scene(std::int64_t scene_id) const override {
    return store_.read_scene(scene_id);
  }
  Result<Retirement> retire_path(const Uuid& report_uuid, const AuditEntry* audit) override {
    return store_.retire_path(report_uuid, audit);
  }
  /// Called when a task is to be reset; may retire some of its paths, and throw.
  std::function<void(std::string_view task)> on_reset = [](std::string_view) {};
  Result<Retirement> reset_task(std::string_view task, const std::stop_token& stop,
                                const AuditEntry* audit) override {
    on_reset(task);
    return store_.reset_task(task, stop, audit);
  }
  Result<std::vector<Digest>> rename_task(std::string_view task, std::string_view name,
                                          const AuditEntry* audit) override {
    return store_.rename_task(task, name, audit);
  }
  Result<store::RemovedTask> remove_task(std::string_view task, const std::stop_token& stop,
                                         const AuditEntry* audit) override {
    return store_.remove_task(task, stop, audit);
  }
  mutable std::atomic<std::size_t> name_searches = 0;
  std::vector<std::string> task_names(const store::WantedNames& wanted) const override {
    ++name_searches;
    return store_.task_names(wanted);
  }
  std::vector<Uuid> reports_between(const Uuid& first, const Uuid& last,
                                    std::size_t limit) const override {
    return store_.reports_between(first, last, limit);
  }
  /// Called before the sums of attempts are read; may block.
  std::function<void()> on_totals = [] {};
  store::AttemptTotals attempt_totals(const Digest& robot, std::string_view task) const override {
    on_totals();
    return store_.attempt_totals(robot, task);
  }
  mutable std::atomic<int> uses_noted = 0;
  void note_use(const Digest& id) const override {
    ++uses_noted;
    store_.note_use(id);
  }
  bool evict_distribution(const Digest& id, const AuditEntry* audit) override {
    return store_.evict_distribution(id, audit);
  }
  /// Called before an entry is added to the audit log; may throw.
  std::function<void(const AuditEntry&)> on_audit = [](const AuditEntry&) {};
  void add_audit(const AuditEntry& entry) override {
    on_audit(entry);
    store_.add_audit(entry);
  }
  store::Page<AuditEntry> list_audit(std::string_view name, std::string_view cursor,
                                     std::size_t limit) const override {
    return store_.list_audit(name, cursor, limit);
  }
  store::Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                       std::string_view cursor, std::size_t limit,
                                       std::size_t max_bytes) const override {
    return store_.export_attempts(robot, task, cursor, limit, max_bytes);
  }
  /// Called when a backup begins; may block.
  std::function<void()> on_backup = [] {};
  Result<bool> backup(const std::filesystem::path& file,
                      const std::function<bool(double)>& progress) const override {
    on_backup();
    return store_.backup(file, progress);
  }
  /// Called before a distribution is stored; may throw.
  std::function<void(const store::FitRight&)> on_put = [](const store::FitRight&) {};
  std::uint64_t put_distribution(const Distribution& distribution,
                                 const store::FitRight& right) override {
    on_put(right);
    return store_.put_distribution(distribution, right);
  }
  std::optional<Distribution> find_distribution(const Digest& id) const override {
    return store_.find_distribution(id);
  }
  void put_rehearsal(const store::StoredRehearsal& rehearsal,
                     const store::RehearsalLimits& limits) override {
    store_.put_rehearsal(rehearsal, limits);
  }
  std::vector<store::StoredRehearsal> read_rehearsals(std::size_t limit) const override {
    return store_.read_rehearsals(limit);
  }
  store::Page<RobotSummary> list_robots(std::string_view cursor, std::size_t limit) const override {
    return store_.list_robots(cursor, limit);
  }
  store::Page<TaskSummary> list_tasks(std::string_view cursor, std::size_t limit) const override {
    return store_.list_tasks(cursor, limit);
  }
  std::optional<TaskSummary> find_task(std::string_view task) const override {
    return store_.find_task(task);
  }
  store::Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                                      std::string_view cursor, std::size_t limit) const override {
    return store_.list_paths(robot, task, cursor, limit);
  }
  store::Page<AttemptSummary> list_attempts(const std::optional<Digest>& robot,
                                            std::string_view task, std::string_view cursor,
                                            std::size_t limit) const override {
    return store_.list_attempts(robot, task, cursor, limit);
  }
  store::Page<AttemptSummary> find_attempts(const store::WantedAttempts& wanted,
                                            std::string_view cursor,
                                            std::size_t limit) const override {
    return store_.find_attempts(wanted, cursor, limit);
  }
  std::optional<Attempt> find_attempt(const Uuid& report_uuid) const override {
    return store_.find_attempt(report_uuid);
  }
  store::Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                                      std::string_view task,
                                                      std::string_view cursor,
                                                      std::size_t limit) const override {
    return store_.list_distributions(robot, task, cursor, limit);
  }

 private:
  template <typename Call>
  std::invoke_result_t<Call> exchange(Call call) const {
    on_exchange();
    auto result = call();
    on_exchange();
    return result;
  }

  mutable std::mutex given_back_mutex_;
  std::vector<std::pair<Digest, std::uint64_t>> given_back_;  // guarded by given_back_mutex_
  Store& store_;
  const std::function<void()> on_paths_read_;
};

}  // namespace kinship::store
