#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"
#include "server/store/values/experience_key.hpp"

/// Retirement of paths and removal of robots by administrators, with entries in the audit log;
/// without `audit` no entry. Attempts and paths stay for the record. Of several transactions the
/// first entry says Begun, the last Done.
namespace kinship::store {

/// Retires paths of a locked robot and task, up to an id, at most `limit`. Given by the engine.
/// \return number of paths.
using RetireSome =
    std::function<std::int64_t(const ExperienceKey& key, std::int64_t limit, std::int64_t last_id)>;

/// The paths of a task that a reset retires.
struct TaskReset {
  std::int64_t task_id = 0;
  std::int64_t last_path_id = 0;  ///< later paths stay
};

/// \return NotFound for an unknown task.
Result<TaskReset> begin_reset(Session& session, std::string_view task, const AuditEntry* audit);

/// The result of one transaction of a change that takes several.
template <typename Counted>
struct Step {
  Counted counted;  ///< in this and all earlier ones, without undone ones
  bool is_last = false;
};

/// Retires some paths of a reset, few enough that reports do not wait long.
/// \param retired  so far.
Step<Retirement> continue_reset(Session& session, const TaskReset& reset, Retirement retired,
                                const RetireSome& retire_some, const AuditEntry* audit);

/// Retires some of a robot's paths, as continue_reset(); once none is left, takes the robot out.
/// \param removed  so far. \return NotFound if it is not registered.
Result<Step<RemovedRobot>> continue_removal(Session& session, const Digest& robot,
                                            RemovedRobot removed, const RetireSome& retire_some,
                                            const AuditEntry* audit);

/// Run a change to its end, or until `stop` between two steps.
/// \param step  runs continue_reset(), or continue_removal(), in a transaction.
Result<Retirement> reset_in_steps(std::string_view task, const std::stop_token& stop,
                                  const std::function<Step<Retirement>(const Retirement&)>& step);
Result<RemovedRobot> remove_in_steps(
    const Digest& robot, const std::stop_token& stop,
    const std::function<Result<Step<RemovedRobot>>(const RemovedRobot&)>& step);

/// Adds a robot to the robots whose paths were retired.
void add_robot(Retirement& retired, const Digest& robot);

/// Reasons why a report retires nothing. \param is_solved  it had a path, beyond the cap.
Error no_such_report(const Uuid& report);
Error report_without_path(const Uuid& report, bool is_solved);

}  // namespace kinship::store
