#include "client/link/robot_names.hpp"

#include <algorithm>

#include "client/link/admin_rows.hpp"

namespace kinship::link {

Result<RobotSummary> find_robot(Client& client, const std::string& name) {
  return row_of<RobotSummary>(client, {.verb = AdminVerb::ShowRobot, .argument = name});
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
