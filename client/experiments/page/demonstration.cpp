#include "client/experiments/page/demonstration.hpp"

#include <algorithm>
#include <cmath>

#include "client/experiments/page/run_reader.hpp"
#include "client/experiments/result_file.hpp"
#include "client/page/drawn_scene.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::experiments {
namespace {

constexpr double kDrawnStep = 0.2;    // joint units between drawn poses of many paths
constexpr double kSmoothStep = 0.03;  // of one path
constexpr Eigen::Index kFrames = 60;

/// The attempt in the middle of those that were solved, by checks; null if none was.
const ProblemResult* median_attempt(const std::vector<ProblemResult>& results) {
  std::vector<const ProblemResult*> solved;
  for (const ProblemResult& result : results)
    if (result.waypoints)
      solved.push_back(&result);
  std::ranges::stable_sort(solved, {}, [](const auto* each) { return each->collision_checks; });
  return solved.empty() ? nullptr : solved[(solved.size() - 1) / 2];
}

}  // namespace

Demonstration demonstrate(const models::LoadedRobot& robot, const Problem& problem,
                          const Eigen::MatrixXd& waypoints, std::uint64_t checks) {
  const Eigen::Isometry3d T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  const Eigen::MatrixXd path = planning::densified(waypoints, kSmoothStep);
  Demonstration demonstration{problem.name,
                              checks,
                              page::drawn_objects(problem.scene),
                              poses_of(robot.chain, T_task_base, path),
                              {}};
  const Eigen::Index count = std::min(kFrames, path.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index place = count == 1 ? 0 : i * (path.cols() - 1) / (count - 1);
    demonstration.frames.push_back(
        {page::bones_of(robot, T_task_base, path.col(place)),
         page::held_objects(robot, problem.attached, T_task_base, path.col(place))});
  }
  return demonstration;
}

FleetMember read_member(const TeacherFiles& files) {
  const models::LoadedRobot robot = models::load_robot(files.robot).value_or_throw();
  const auto problems = read_problems(files.problems, files.robot);
  const auto results = read_results(files.results);
  FleetMember member;
  member.label = robot.description.label;
  member.problems = results.size();
  for (const ProblemResult& result : results) {
    if (!result.waypoints)
      continue;
    const Problem& problem = problem_of(problems, result.name, files.results);
    member.paths.push_back(
        poses_of(robot.chain, problem.T_task_base.value_or(Eigen::Isometry3d::Identity()),
                 planning::densified(checked_path(robot, result, files.results), kDrawnStep)));
  }
  if (const ProblemResult* const median = median_attempt(results))
    member.example =
        demonstrate(robot, problems.at(median->name), *median->waypoints, median->collision_checks);
  return member;
}

}  // namespace kinship::experiments
