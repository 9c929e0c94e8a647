#include "client/experiments/commands.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "client/experiments/page/page.hpp"
#include "client/experiments/page/run_reader.hpp"
#include "client/experiments/python_program.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

void write_station_problems(const StationOptions& options, std::ostream& out,
                            std::ostream& messages) {
  const models::LoadedRobot robot = models::load_robot(options.robot).value_or_throw();
  const std::string& label = robot.description.label;
  const Eigen::Isometry3d T_task_base =
      options.T_task_base.value_or(placement_at(options.station, label));
  std::uint32_t redrawn = 0;
  for (std::uint32_t index = 0; index < options.count; ++index) {
    const Problem problem =
        draw_station_problem(options.station, robot, T_task_base, {options.seed, index, 0});
    if (problem.name.find('.') != std::string::npos)
      ++redrawn;
    out << json::to_json(problem) << '\n';
    if (!out)
      throw Failure(ErrorCode::Storage, "cannot write the problems");
  }
  messages << options.count << " problems for " << label << ", " << redrawn
           << " of them in a scene drawn again\n";
}

void write_placement(Station station, const models::RobotArguments& robot, std::ostream& out) {
  const RobotDescription description = models::describe_robot(robot).value_or_throw().description;
  const PoseArray pose = to_pose_array(placement_at(station, description.label));
  for (std::size_t i = 0; i < pose.size(); ++i)
    out << (i == 0 ? "" : " ") << pose[i];
  out << '\n';
}

void run_comparison(const CompareOptions& options) {
  nlohmann::json asked{{"uniform", options.uniform.string()},
                       {"guided", options.guided.string()},
                       {"also", nlohmann::json::array()},
                       {"as", options.json ? "json" : "table"}};
  for (const AlsoFile& also : options.also)
    asked["also"].push_back({also.name, also.results.string()});
  become_python(python_folder() / "compare.py", {asked.dump()});
}

void write_page(const RunLocation& run, std::ostream& out) {
  write_page(read_run(find_run(run)), out);
  if (!out)
    throw Failure(ErrorCode::Storage, "cannot write the page");
}

}  // namespace kinship::experiments
