#include "server/service/narrowing.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/nearest_name.hpp"
#include "server/access/access.hpp"
#include "server/access/withheld_sources.hpp"
#include "server/service/find_by_name.hpp"

namespace kinship::service {
namespace {

void throw_if(const std::optional<Error>& refusal) {
  if (refusal)
    throw Failure(*refusal);
}

template <typename Row, typename... Rows>
constexpr bool kIsOneOf = (std::is_same_v<Row, Rows> || ...);

template <typename Row>
concept OfTaskAndRobot = requires(Row row) {
  row.task;
  row.label;
};

/// Rows that name neither a task nor a robot of others, or whose request was checked.
template <typename Row>
constexpr bool kIsPassedWhole =
    kIsOneOf<Row, ServerStatus, Explanation, ExportedRobot, Eviction, Job, ClientUse, BackupSummary,
             AuditEntry, StoredMesh, TextLine>;

/// Troubles of others may name their tasks and robots.
void strip(ServerStatus& status) {
  for (TroubleCount& trouble : status.troubles)
    trouble.last.clear();
}

}  // namespace

/// Of a robot that is not registered (any more) its digest, which no pattern is for.
std::string Narrowing::label_of(const Digest& robot) const {
  const std::optional<store::RobotRecord> record = store_.find_robot(robot);
  return record ? record->description.label : robot.hex();
}

/// A name of no robot, or of several, stays as it is.
std::string Narrowing::label_of(const std::string& name) const {
  const Result<RobotSummary> robot = find_robot(store_, name);
  return robot ? robot->label : name;
}

void Narrowing::check(const AdminRequest& request) const {
  if (!access::is_narrowed(caller_))
    return;
  if (!request.task.empty())
    throw_if(access::refusal_of_task(caller_, request.task));
  if (!request.robot.empty() && !caller_.robots.empty() &&
      access::refusal_of_robot(caller_, label_of(request.robot)))
    throw_if(access::refusal_of_robot(caller_, request.robot));
  if (request.verb == AdminVerb::RestorePath && request.argument.empty())
    check_filters_of_restoration(request);
  check_argument(request);
}

/// Without them it would restore paths of others.
void Narrowing::check_filters_of_restoration(const AdminRequest& request) const {
  if (!caller_.tasks.empty() && request.task.empty())
    throw Failure(ErrorCode::InvalidInput,
                  "restore_path: your certificate is for some tasks: name one of them");
  if (!caller_.robots.empty() && request.robot.empty())
    throw Failure(ErrorCode::InvalidInput,
                  "restore_path: your certificate is for some robots: name one of them");
}

void Narrowing::check_argument(const AdminRequest& request) const {
  switch (rule_of(request.verb).argument) {
    case VerbArgument::Task:
      return throw_if(access::refusal_of_task(caller_, request.argument));
    case VerbArgument::Robot:  // of RenameRobot the label that it shall have
      if (access::refusal_of_robot(caller_, label_of(request.argument)))
        throw_if(access::refusal_of_robot(caller_, request.argument));
      return;
    case VerbArgument::Report:
      return check_report(request.argument);
    case VerbArgument::Distribution:
      return check_distribution(request.argument);
    default:
      return;
  }
}

void Narrowing::check_report(const std::string& uuid) const {
  if (uuid.empty())  // of RestorePath, which then has filters
    return;
  constexpr std::size_t kMaxAlike = 100;
  std::vector<Uuid> reports;
  if (const std::optional<Uuid> whole = Uuid::parse(uuid))
    reports.push_back(*whole);
  else
    reports = reports_like(store_, uuid, kMaxAlike);
  const auto is_others = [this](const Uuid& report) {
    const std::optional<Attempt> attempt = store_.find_attempt(report);
    return attempt && !access::may_see(caller_, attempt->task, label_of(attempt->robot));
  };
  // That several begin alike is said only where all are the caller's.
  if (std::ranges::any_of(reports, is_others))
    throw Failure(not_found("report", uuid));
}

void Narrowing::check_distribution(const std::string& prefix) const {
  const Digest id = find_distribution_id(store_, prefix).value_or_throw();
  const std::optional<Distribution> found = store_.find_distribution(id);
  if (found && !access::may_see(caller_, found->task, label_of(found->robot)))
    throw Failure(not_found("distribution", prefix));
}

void Narrowing::apply(AdminPage& page) const {
  if (!access::is_narrowed(caller_))
    return;
  std::erase_if(page.rows, [this](AdminRow& row) { return !keeps(row); });
  page.message = without_suggestion(std::move(page.message));
}

/// Also cuts the parts of a row that are about others.
bool Narrowing::keeps(AdminRow& row) const {
  const auto may_see = [this](const std::string& task, const std::string& robot) {
    return access::may_see(caller_, task, robot);
  };
  if (auto* const task = std::get_if<TaskSummary>(&row)) {
    std::erase_if(task->robots, [&](const auto& robot) { return !may_see("", robot.label); });
    task->paths = task->attempts = task->dropped = 0;
    for (const TaskRobotSummary& robot : task->robots) {
      task->paths += robot.paths;
      task->attempts += robot.attempts;
      task->dropped += robot.dropped;
    }
    return may_see(task->task, "") && (caller_.robots.empty() || !task->robots.empty());
  }
  if (const auto* const robot = std::get_if<ExportedRobot>(&row))
    return may_see("", robot->description.label);
  if (const auto* const attempt = std::get_if<Attempt>(&row))
    return may_see(attempt->task, caller_.robots.empty() ? "" : label_of(attempt->robot));
  if (auto* const distribution = std::get_if<Distribution>(&row))
    access::withhold_sources(caller_, *distribution);
  if (auto* const explanation = std::get_if<Explanation>(&row)) {
    access::withhold_sources(caller_, explanation->distribution);
    std::erase_if(explanation->experience,
                  [&](const auto& robot) { return !may_see("", robot.label); });
  }
  if (auto* const status = std::get_if<ServerStatus>(&row))
    strip(*status);
  return std::visit(
      [&](const auto& value) {
        if constexpr (OfTaskAndRobot<decltype(value)>)
          return may_see(value.task, value.label);
        else if constexpr (requires { value.label; })
          return may_see("", value.label);
        else if constexpr (requires { value.task; })
          return may_see(value.task, "");
        else
          static_assert(kIsPassedWhole<std::remove_cvref_t<decltype(value)>>);
        return true;
      },
      row);
}

}  // namespace kinship::service
