#include "server/service/administration.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "robots/inverse/inverse.hpp"

namespace kinship::service {
namespace {

constexpr std::size_t kLeastPrefix = 4;
constexpr std::size_t kDigestDigits = 64;

std::size_t page_size(const AdminRequest& request) {
  return std::clamp<std::size_t>(request.limit, 1, kMaxPageRows);
}

template <typename Row>
AdminPage page_of(store::Page<Row> page) {
  AdminPage answer;
  answer.status = AdminStatus::Ok;
  for (Row& row : page.rows)
    answer.rows.emplace_back(std::move(row));
  answer.next_cursor = std::move(page.next_cursor);
  return answer;
}

template <typename Row>
AdminPage page_of(Row row) {
  AdminPage answer;
  answer.status = AdminStatus::Ok;
  answer.rows.emplace_back(std::move(row));
  return answer;
}

AdminPage page_of(const Error& error) {
  AdminPage answer;
  answer.message = error.message;
  switch (error.code) {
    case ErrorCode::NotFound:
      answer.status = AdminStatus::NotFound;
      break;
    case ErrorCode::InvalidInput:
    case ErrorCode::Conflict:
    case ErrorCode::TooLarge:
      answer.status = AdminStatus::Refused;
      break;
    default:
      answer.status = AdminStatus::Failed;
  }
  return answer;
}

Error not_found(const std::string& what, const std::string& name) {
  return {ErrorCode::NotFound, "no " + what + " '" + name + "'"};
}

bool is_hexadecimal(std::string_view text) {
  return !text.empty() &&
         text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

/// \return lower-case digits, or empty if `text` is no prefix of a digest.
std::string digest_prefix(std::string_view text) {
  if (text.size() < kLeastPrefix || text.size() > kDigestDigits || !is_hexadecimal(text))
    return {};
  std::string prefix;
  for (const char c : text)
    prefix += c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
  return prefix;
}

bool begins_with(const Digest& digest, const std::string& prefix) {
  return digest.hex().compare(0, prefix.size(), prefix) == 0;
}

void allow_no_filter(const AdminRequest& request) {
  if (!request.robot.empty() || !request.task.empty())
    throw Failure(ErrorCode::InvalidInput, "this list has no filters");
}

}  // namespace

AdminPage Administration::answer(const AdminRequest& request) {
  try {
    return dispatch(request);
  } catch (const Failure& failure) {
    return page_of(failure.error());
  } catch (const std::exception& exception) {
    return page_of(Error{ErrorCode::Internal, exception.what()});
  }
}

AdminPage Administration::dispatch(const AdminRequest& request) {
  switch (request.verb) {
    case AdminVerb::Status:
      return page_of(status_());
    case AdminVerb::ListRobots:
      return list_robots(request);
    case AdminVerb::ShowRobot:
      return show_robot(request.argument);
    case AdminVerb::ListTasks:
      allow_no_filter(request);
      return page_of(store_.list_tasks(request.cursor, page_size(request)));
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
    default:
      break;
  }
  return page_of(Error{ErrorCode::InvalidInput, "this server does not know the verb"});
}

AdminPage Administration::list_robots(const AdminRequest& request) {
  allow_no_filter(request);
  store::Page<RobotSummary> page = store_.list_robots(request.cursor, page_size(request));
  for (RobotSummary& summary : page.rows)
    name_solver(summary);
  return page_of(std::move(page));
}

AdminPage Administration::list_paths(const AdminRequest& request) {
  const std::optional<Digest> robot = robot_filter(request);
  check_task_filter(request);
  return page_of(store_.list_paths(robot, request.task, request.cursor, page_size(request)));
}

AdminPage Administration::list_distributions(const AdminRequest& request) {
  const std::optional<Digest> robot = robot_filter(request);
  check_task_filter(request);
  return page_of(
      store_.list_distributions(robot, request.task, request.cursor, page_size(request)));
}

AdminPage Administration::show_robot(const std::string& name) {
  store::RobotRecord record = find_robot(name).value_or_throw();
  RobotSummary summary = summary_of(record.digest);
  name_solver(summary);
  AdminPage page = page_of(std::move(summary));
  page.rows.emplace_back(std::move(record.description));
  return page;
}

AdminPage Administration::show_task(const std::string& task) {
  std::optional<TaskSummary> summary = store_.find_task(task);
  return summary ? page_of(std::move(*summary)) : page_of(not_found("task", task));
}

AdminPage Administration::show_path(const std::string& uuid) {
  const std::optional<Uuid> report = Uuid::parse(uuid);
  if (!report)
    return page_of(Error{ErrorCode::InvalidInput, "'" + uuid + "' is not a report's UUID"});
  std::optional<Attempt> attempt = store_.find_attempt(*report);
  return attempt ? page_of(std::move(*attempt)) : page_of(not_found("report", uuid));
}

AdminPage Administration::show_distribution(const std::string& prefix) {
  const Digest id = find_distribution_id(prefix).value_or_throw();
  std::optional<Distribution> distribution = store_.find_distribution(id);
  return distribution ? page_of(std::move(*distribution))
                      : page_of(not_found("distribution", prefix));
}

Result<store::RobotRecord> Administration::find_robot(const std::string& name) const {
  std::vector<store::RobotRecord> robots = store_.robots();
  const auto labelled = std::find_if(robots.begin(), robots.end(), [&](const auto& robot) {
    return robot.description.label == name;
  });
  if (labelled != robots.end())
    return std::move(*labelled);
  const std::string prefix = digest_prefix(name);
  if (!prefix.empty())
    std::erase_if(robots, [&](const auto& robot) { return !begins_with(robot.digest, prefix); });
  if (prefix.empty() && name.size() < kLeastPrefix && is_hexadecimal(name))
    return Error{ErrorCode::NotFound, not_found("robot", name).message +
                                          "; a prefix of a digest needs at least " +
                                          std::to_string(kLeastPrefix) + " digits"};
  if (prefix.empty() || robots.empty())
    return not_found("robot", name);
  if (robots.size() == 1)
    return std::move(robots.front());
  return Error{ErrorCode::Conflict,
               "robot '" + name + "' could be '" + robots[0].description.label + "' (" +
                   robots[0].digest.short_hex() + ") or '" + robots[1].description.label + "' (" +
                   robots[1].digest.short_hex() + ")"};
}

std::optional<Digest> Administration::robot_filter(const AdminRequest& request) const {
  if (request.robot.empty())
    return std::nullopt;
  return find_robot(request.robot).value_or_throw().digest;
}

void Administration::check_task_filter(const AdminRequest& request) const {
  if (!request.task.empty() && !store_.find_task(request.task))
    throw Failure(not_found("task", request.task));
}

Result<Digest> Administration::find_distribution_id(const std::string& name) const {
  if (const std::optional<Digest> id = Digest::from_hex(name))
    return *id;
  const std::string prefix = digest_prefix(name);
  if (prefix.empty())
    return Error{ErrorCode::InvalidInput,
                 "'" + name + "' is not a prefix of a distribution's id: at least " +
                     std::to_string(kLeastPrefix) + " hexadecimal digits"};
  std::optional<Digest> found;
  std::string cursor;
  do {
    const store::Page<DistributionSummary> page =
        store_.list_distributions(std::nullopt, {}, cursor, kMaxPageRows);
    for (const DistributionSummary& summary : page.rows) {
      if (!begins_with(summary.id, prefix))
        continue;
      if (found)
        return Error{ErrorCode::Conflict, "distribution '" + name + "' could be " +
                                              found->short_hex() + " or " + summary.id.short_hex()};
      found = summary.id;
    }
    cursor = page.next_cursor;
  } while (!cursor.empty());
  if (!found)
    return not_found("distribution", name);
  return *found;
}

RobotSummary Administration::summary_of(const Digest& robot) const {
  std::string cursor;
  do {
    const store::Page<RobotSummary> page = store_.list_robots(cursor, kMaxPageRows);
    for (const RobotSummary& summary : page.rows)
      if (summary.robot == robot)
        return summary;
    cursor = page.next_cursor;
  } while (!cursor.empty());
  throw Failure(not_found("robot", robot.short_hex()));
}

void Administration::name_solver(RobotSummary& summary) {
  const Result<RobotRegistry::RobotPointer> robot = robots_.find(summary.robot);
  summary.solver = robot ? inverse::solver_name(robot.value()->chain) : robot.error().message;
}

}  // namespace kinship::service
