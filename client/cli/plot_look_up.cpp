#include "client/cli/plot_look_up.hpp"

#include "client/link/admin_rows.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::cli {
Result<KnownRobot> find_known_robot(link::Client& server, const std::string& name) {
  const auto rows = link::rows_of(server, {.verb = AdminVerb::ShowRobot, .argument = name});
  if (!rows)
    return rows.error();
  if (rows->size() < 2)
    return Error{ErrorCode::Internal, "the server answered without a row"};
  return KnownRobot{json::row_from_json<RobotSummary>(rows->front()).value_or_throw(),
                    json::robot_description_from_json(rows->back()).value_or_throw()};
}

plots::LookUp look_up_of(link::Client& server) {
  const auto first_row = [&server](AdminVerb verb, const std::string& name) {
    return link::first_row_of(server, {.verb = verb, .argument = name}).value_or_throw();
  };
  return {
      .for_each_path =
          [&server](const std::string& task, const std::optional<Digest>& robot, const auto& take) {
            const auto error = link::for_each_row(
                server,
                {.verb = AdminVerb::ListPaths, .robot = robot ? robot->hex() : "", .task = task},
                [&](const std::string& row) {
                  return take(json::row_from_json<PathSummary>(row).value_or_throw());
                });
            if (error)
              throw Failure(*error);
          },
      .attempt =
          [first_row](const Uuid& report) {
            return json::stored_attempt_from_json(first_row(AdminVerb::ShowPath, report.text()))
                .value_or_throw()
                .attempt;
          },
      .robot =
          [&server](const Digest& robot) {
            return find_known_robot(server, robot.hex()).value_or_throw().description;
          },
      .distributions =
          [&server](const std::string& task, const Digest& robot) {
            std::vector<DistributionSummary> kept;
            for (const std::string& row :
                 link::rows_of(
                     server,
                     {.verb = AdminVerb::ListDistributions, .robot = robot.hex(), .task = task})
                     .value_or_throw())
              kept.push_back(json::row_from_json<DistributionSummary>(row).value_or_throw());
            return kept;
          },
      .distribution =
          [first_row](const Digest& id) {
            return json::distribution_from_json(first_row(AdminVerb::ShowDistribution, id.hex()))
                .value_or_throw();
          }};
}

}  // namespace kinship::cli
