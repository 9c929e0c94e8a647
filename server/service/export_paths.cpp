#include "server/service/export_paths.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>

#include "proto/types/limits.hpp"

namespace kinship::service {
namespace {

/// Cursors name the part they belong to: the digest of the last robot, or the store's own cursor.
constexpr std::string_view kRobots = "robots ", kAttempts = "attempts ";
/// Of 8 bytes each; as text a value has up to 24.
constexpr std::size_t kAttemptBytes = kMaxPageBytes / 3;
constexpr std::size_t kUrdfBytes = kMaxPageBytes / 2;

std::set<Digest> robots_with_attempts(const store::Store& store, const std::string& task) {
  std::set<Digest> robots;
  if (!task.empty()) {
    if (const std::optional<TaskSummary> summary = store.find_task(task))
      for (const TaskRobotSummary& robot : summary->robots)
        if (robot.attempts > 0)
          robots.insert(robot.robot);
    return robots;
  }
  std::string cursor;
  do {
    const store::Page<RobotSummary> page = store.list_robots(cursor, kMaxPageRows);
    for (const RobotSummary& robot : page.rows)
      if (robot.attempts > 0)
        robots.insert(robot.robot);
    cursor = page.next_cursor;
  } while (!cursor.empty());
  return robots;
}

/// The robots that the file needs after `last`, by digest.
std::vector<store::RobotRecord> needed_robots(const store::Store& store,
                                              const std::optional<Digest>& robot,
                                              const std::string& task,
                                              const std::optional<Digest>& last) {
  const std::set<Digest> needed = robots_with_attempts(store, task);
  std::vector<store::RobotRecord> robots = store.robots();
  std::erase_if(robots, [&](const store::RobotRecord& record) {
    return !needed.contains(record.digest) || (robot && record.digest != *robot) ||
           (last && record.digest <= *last);
  });
  std::sort(robots.begin(), robots.end(),
            [](const auto& a, const auto& b) { return a.digest < b.digest; });
  return robots;
}

AdminPage robot_page(std::vector<store::RobotRecord> robots, std::size_t limit) {
  AdminPage page;
  page.status = AdminStatus::Ok;
  page.next_cursor = kAttempts;
  std::size_t bytes = 0;
  for (store::RobotRecord& robot : robots) {
    bytes += robot.description.urdf.size();
    if (page.rows.size() == limit || (!page.rows.empty() && bytes > kUrdfBytes))
      return page;
    page.rows.emplace_back(ExportedRobot{std::move(robot.description)});
    const bool is_last = &robot == &robots.back();
    page.next_cursor = is_last ? std::string(kAttempts) : std::string(kRobots) + robot.digest.hex();
  }
  return page;
}

}  // namespace

AdminPage export_paths(const store::Store& store, const std::optional<Digest>& robot,
                       const AdminRequest& request) {
  const std::string_view cursor = request.cursor;
  if (!cursor.starts_with(kAttempts)) {
    std::optional<Digest> last;
    if (cursor.starts_with(kRobots))
      last = Digest::from_hex(cursor.substr(kRobots.size()));
    if (!cursor.empty() && !last)
      throw Failure(ErrorCode::InvalidInput, "'" + request.cursor + "' is no cursor of an export");
    std::vector<store::RobotRecord> robots = needed_robots(store, robot, request.task, last);
    if (!robots.empty())
      return robot_page(std::move(robots), page_size(request));
  }
  const std::string_view inner =
      cursor.starts_with(kAttempts) ? cursor.substr(kAttempts.size()) : std::string_view();
  store::Page<Attempt> attempts =
      store.export_attempts(robot, request.task, inner, page_size(request), kAttemptBytes);
  if (!attempts.next_cursor.empty())
    attempts.next_cursor = std::string(kAttempts) + attempts.next_cursor;
  return page_of(std::move(attempts));
}

}  // namespace kinship::service
