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

/// Paths and robots that people take out of every fit, and the entries of the audit log that say
/// so; without `audit` none is kept. What they brought stays for the record. Where that takes many
/// transactions the first entry says Begun, the last Done.
namespace kinship::store {

/// How an engine retires paths of a robot and task that is locked, up to an id, `limit` at most.
/// \return how many.
using RetireSome =
    std::function<std::int64_t(const ExperienceKey& key, std::int64_t limit, std::int64_t last_id)>;

/// Which paths of a task are to be retired.
struct TaskReset {
  std::int64_t task_id = 0;
  std::int64_t last_path_id = 0;  ///< those that come later stay
};

/// \return NotFound for an unknown task.
Result<TaskReset> begin_reset(Session& session, std::string_view task, const AuditEntry* audit);

/// A transaction of a change that takes many.
template <typename Counted>
struct Step {
  Counted counted;  ///< in this and all before it; what is undone is not counted
  bool is_last = false;
};

/// Retires some of the paths of a reset, few enough that reports do not wait long.
/// \param retired  so far.
Step<Retirement> continue_reset(Session& session, const TaskReset& reset, Retirement retired,
                                const RetireSome& retire_some, const AuditEntry* audit);

/// Retires some of a robot's paths, as continue_reset(); once none is left, takes the robot out.
/// \param removed  so far. \return NotFound if it is not registered.
Result<Step<RemovedRobot>> continue_removal(Session& session, const Digest& robot,
                                            RemovedRobot removed, const RetireSome& retire_some,
                                            const AuditEntry* audit);

/// Run a change to its end, or until it is to stop between two steps.
/// \param step  runs continue_reset(), or continue_removal(), in a transaction.
Result<Retirement> reset_in_steps(std::string_view task, const std::stop_token& stop,
                                  const std::function<Step<Retirement>(const Retirement&)>& step);
Result<RemovedRobot> remove_in_steps(
    const Digest& robot, const std::stop_token& stop,
    const std::function<Result<Step<RemovedRobot>>(const RemovedRobot&)>& step);

/// Adds a robot to those that paths were retired of.
void add_robot(Retirement& retired, const Digest& robot);

/// Why nothing is retired with a report. \param is_solved  it had a path, beyond the cap.
Error no_such_report(const Uuid& report);
Error report_without_path(const Uuid& report, bool is_solved);

}  // namespace kinship::store
