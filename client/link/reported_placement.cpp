#include "client/link/reported_placement.hpp"

#include "proto/json/attempt_json.hpp"

namespace kinship::link {
namespace {

/// \return also NotFound for an attempt that was dropped between the two requests.
Result<ReportedPlacement> newest_placement(const AskAdmin& ask, const std::string& task,
                                           const std::string& robot) {
  std::optional<Result<AttemptSummary>> newest;
  const auto error = for_each_row(
      ask, {.verb = AdminVerb::FindAttempts, .robot = robot, .task = task},
      [&](const std::string& row) {
        newest.emplace(json::row_from_json<AttemptSummary>(row));
        return false;
      },
      1);
  if (error && error->code != ErrorCode::NotFound)
    return *error;
  if (!newest)  // also of a task or robot that the server does not know
    return ReportedPlacement();
  if (!*newest)
    return unreadable_row(newest->error());
  const Result<std::string> row =
      first_row_of(ask, {.verb = AdminVerb::ShowPath, .argument = (*newest)->report_uuid.text()});
  if (!row)
    return row.error();
  const auto named = json::stored_attempt_from_json(*row);
  if (!named)
    return unreadable_row(named.error());
  return ReportedPlacement{true, named->attempt.T_task_base};
}

}  // namespace

Result<ReportedPlacement> reported_placement(const AskAdmin& ask, const std::string& task,
                                             const std::string& robot) {
  const auto is_dropped = [](const Result<ReportedPlacement>& placement) {
    return !placement && placement.error().code == ErrorCode::NotFound;
  };
  Result<ReportedPlacement> placement = newest_placement(ask, task, robot);
  if (is_dropped(placement))
    placement = newest_placement(ask, task, robot);
  return is_dropped(placement) ? ReportedPlacement() : placement;
}

Result<ReportedPlacement> reported_placement(Client& client, const std::string& task,
                                             const std::string& robot) {
  return reported_placement(
      [&client](const AdminRequest& request) { return client.admin(request); }, task, robot);
}

}  // namespace kinship::link
