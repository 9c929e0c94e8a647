#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/store/search_room.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/retirement.hpp"

namespace kinship::store {

/// What both engines do alike: the statements of server/store/tables over their sessions. An engine
/// adds its sessions, the statements that it plans in its own way, reports, history and upkeep.
class SqlStore : public Store {
 public:
  Result<RegisterStatus> register_robot(const RobotRecord& robot) override;
  bool replace_geometry(const RobotRecord& robot) override;
  Result<bool> rename_robot(const Digest& robot, const std::string& label,
                            const AuditEntry* audit) override;
  Result<RemovedRobot> remove_robot(const Digest& robot, const std::stop_token& stop,
                                    const AuditEntry* audit) override;
  std::map<Digest, std::uint64_t> geometry_revisions() const override;
  std::optional<RobotRecord> find_robot(const Digest& robot) const override;
  std::vector<RobotRecord> robots() const override;
  MeshesPut put_meshes(const Digest& robot, const std::vector<MeshContent>& contents,
                       const MeshLimits& limits) override;
  std::optional<MeshContent> find_mesh(const Digest& content) const override;
  std::map<Digest, std::uint64_t> known_meshes(const std::set<Digest>& contents) const override;
  MeshUse mesh_use() const override;

  std::vector<ExperienceSummary> experience(std::string_view task) const override;
  std::uint64_t generation(const Digest& robot, std::string_view task) const override;
  Page<AttemptSummary> find_attempts(const WantedAttempts& wanted, std::string_view cursor,
                                     std::size_t limit) const override;
  AttemptTotals attempt_totals(const Digest& robot, std::string_view task) const override;
  Result<Retirement> reset_task(std::string_view task, const std::stop_token& stop,
                                const AuditEntry* audit) override;
  Result<std::vector<Digest>> rename_task(std::string_view task, std::string_view name,
                                          const AuditEntry* audit) override;
  Result<RemovedTask> remove_task(std::string_view task, const std::stop_token& stop,
                                  const AuditEntry* audit) override;
  std::vector<std::string> task_names(const WantedNames& wanted) const override;
  std::vector<Uuid> reports_between(const Uuid& first, const Uuid& last,
                                    std::size_t limit) const override;

  std::uint64_t put_distribution(const Distribution& distribution, const FitRight& right) override;
  std::optional<Distribution> find_distribution(const Digest& id) const override;
  bool evict_distribution(const Digest& id, const AuditEntry* audit) override;

  void put_rehearsal(const StoredRehearsal& rehearsal, const RehearsalLimits& limits) override;
  std::vector<StoredRehearsal> read_rehearsals(std::size_t limit) const override;

  void add_audit(const AuditEntry& entry) override;
  std::map<std::string, std::string> notes(std::string_view prefix) const override;
  void put_notes(const std::map<std::string, std::optional<std::string>>& notes) override;

  Page<RobotSummary> list_robots(std::string_view cursor, std::size_t limit) const override;
  Page<TaskSummary> list_tasks(std::string_view cursor, std::size_t limit) const override;
  std::optional<TaskSummary> find_task(std::string_view task) const override;
  Page<AuditEntry> list_audit(std::string_view name, std::string_view cursor,
                              std::size_t limit) const override;

 protected:
  /// \param max_distribution_bytes  of all distributions; 0: no limit.
  SqlStore(std::uint64_t max_distribution_bytes, const SearchLimits& searches)
      : max_distribution_bytes_(max_distribution_bytes), search_room_(searches) {}

  /// What a reading sees.
  enum class View {
    EachStatement,  ///< the state of its time
    Snapshot        ///< one state
  };
  using Reading = std::function<void(Session&)>;
  /// In a transaction; the second argument retires paths in it.
  using Writing = std::function<void(Session&, const RetireSome&)>;

  /// Takes search records from reports if none is to be kept.
  /// \return whether records have to be let go after this commit.
  template <typename Reported>
  bool admit_searches(std::vector<Reported>& reports) {
    return search_room_.admit(reports);
  }
  /// On the writer's thread; no caller waits for it.
  void trim_searches_later() const;
  std::uint64_t search_bytes(Session& session) const { return search_room_.used(session); }

  /// As the last robots() saw them.
  std::size_t damaged_robots() const noexcept { return damaged_robots_; }

 private:
  /// Runs a reading, in a snapshot where the engine has none for each statement; once more after a
  /// lost connection.
  virtual void run_reading(View view, const Reading& reading) const = 0;
  /// Runs a change, perhaps more than once; on return the last run is durable.
  virtual void run_writing(const Writing& writing) = 0;
  /// The same on the writer's thread; no caller waits for it, and it may be lost.
  virtual void run_writing_later(Writing writing) const = 0;
  /// \throws Failure(Unavailable) if another server has taken the right to fit.
  virtual void require_fit_right(Session& /*session*/, const Digest& /*distribution*/,
                                 const FitRight& /*right*/) {}

  template <typename Read>
  std::invoke_result_t<Read, Session&> read(View view, Read reading) const {
    std::optional<std::invoke_result_t<Read, Session&>> value;
    run_reading(view, [&](Session& session) { value.emplace(reading(session)); });
    return std::move(value).value();
  }
  template <typename Write>
  std::invoke_result_t<Write, Session&, const RetireSome&> write(Write writing) {
    std::optional<std::invoke_result_t<Write, Session&, const RetireSome&>> value;
    run_writing([&](Session& session, const RetireSome& retire_some) {
      value.emplace(writing(session, retire_some));
    });
    return std::move(value).value();
  }

  const std::uint64_t max_distribution_bytes_;
  mutable SearchRoom search_room_;
  mutable std::atomic<std::size_t> damaged_robots_ = 0;
};

}  // namespace kinship::store
