#include "client/link/robot_names.hpp"

#include <algorithm>

#include "client/link/admin_rows.hpp"
#include "proto/json/summaries_json.hpp"

namespace kinship::link {

Result<RobotSummary> find_robot(Client& client, const std::string& name) {
  AdminRequest request;
  request.verb = AdminVerb::ShowRobot;
  request.argument = name;
  const Result<std::vector<std::string>> rows = rows_of(client, request);
  if (!rows)
    return rows.error();
  if (rows->empty())
    return Error{ErrorCode::Internal, "the server said nothing of robot '" + name + "'"};
  Result<RobotSummary> summary = json::robot_summary_from_json(rows->front());
  if (!summary)
    return Error{ErrorCode::Internal,
                 "robot '" + name + "': cannot read the server's row: " + summary.error().message};
  return summary;
}

Result<std::vector<Digest>> resolve_robots(Client& client, const std::vector<std::string>& names) {
  std::vector<Digest> robots;
  robots.reserve(names.size());
  for (const std::string& name : names) {
    const Result<RobotSummary> robot = find_robot(client, name);
    if (!robot)
      return robot.error();
    robots.push_back(robot->robot);
  }
  std::ranges::sort(robots);
  robots.erase(std::unique(robots.begin(), robots.end()), robots.end());
  return robots;
}

}  // namespace kinship::link
