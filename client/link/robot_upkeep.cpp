#include "client/link/robot_upkeep.hpp"

#include "client/link/admin_rows.hpp"

namespace kinship::link {
Result<RobotSummary> rename_robot(Client& server, const std::string& robot,
                                  const std::string& label) {
  return row_of<RobotSummary>(server,
                              {.verb = AdminVerb::RenameRobot, .argument = label, .robot = robot});
}

Result<RobotRemoval> remove_robot(Client& server, const std::string& robot) {
  return row_of<RobotRemoval>(server, {.verb = AdminVerb::RemoveRobot, .argument = robot});
}

}  // namespace kinship::link
