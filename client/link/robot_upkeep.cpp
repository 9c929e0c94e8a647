#include "client/link/robot_upkeep.hpp"

#include <string_view>
#include <vector>

#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/summaries_json.hpp"

namespace kinship::link {
namespace {

/// The one row of a verb.
template <typename Row>
Result<Row> row_of(Client& server, const AdminRequest& request,
                   Result<Row> (*parse)(std::string_view)) {
  const Result<std::vector<std::string>> rows = rows_of(server, request);
  if (!rows)
    return rows.error();
  if (rows->empty())
    return Error{ErrorCode::Internal, "the server answered with nothing"};
  Result<Row> row = parse(rows->front());
  if (!row)
    return Error{ErrorCode::Internal, "cannot read the server's row: " + row.error().message};
  return row;
}

}  // namespace

Result<RobotSummary> rename_robot(Client& server, const std::string& robot,
                                  const std::string& label) {
  AdminRequest request;
  request.verb = AdminVerb::RenameRobot;
  request.robot = robot;
  request.argument = label;
  return row_of(server, request, json::robot_summary_from_json);
}

Result<RobotRemoval> remove_robot(Client& server, const std::string& robot) {
  AdminRequest request;
  request.verb = AdminVerb::RemoveRobot;
  request.argument = robot;
  return row_of(server, request, json::robot_removal_from_json);
}

}  // namespace kinship::link
