#include "pages/plots/task_paths.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "pages/page/json_text.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/failure.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/resample.hpp"

namespace kinship::plots {
namespace {

using page::json_string;
using page::list;
using page::number;
using page::object;

/// Places at which the way of a hand is computed, before those that a line shows are left out.
constexpr TransferParameters kPlacesOfWay{
    .pose_spacing = 0.02, .max_poses_per_path = 65, .dropped_end_share = 0};

/// Distance of a point from the segment between two others.
double distance(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double length2 = along.squaredNorm();
  const double part = length2 > 0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0;
  return (point - from - part * along).norm();
}

Eigen::Matrix3Xd hand_of(const Path& path, const kinematics::Chain& chain,
                         const Eigen::Isometry3d& T_task_base) {
  const Eigen::MatrixXd qs = kinematics::resample(path, kPlacesOfWay);
  Eigen::Matrix3Xd way(3, qs.cols());
  for (Eigen::Index i = 0; i < qs.cols(); ++i)
    way.col(i) = T_task_base * kinematics::T_base_transfer(chain, qs.col(i)).translation();
  return way(Eigen::all, simplified(way, kWayTolerance_m));
}

/// Origins of base, joints and transfer frame.
Eigen::Matrix3Xd arm_of(const Eigen::Ref<const Eigen::VectorXd>& q, const kinematics::Chain& chain,
                        const Eigen::Isometry3d& T_task_base) {
  const std::vector<Eigen::Isometry3d> joints = kinematics::joint_poses(chain, q);
  Eigen::Matrix3Xd arm(3, chain.dof() + 2);
  arm.col(0) = T_task_base.translation();
  for (Eigen::Index i = 0; i < chain.dof(); ++i)
    arm.col(i + 1) = T_task_base * joints[static_cast<std::size_t>(i)].translation();
  arm.rightCols<1>() = T_task_base * kinematics::T_base_transfer(chain, joints).translation();
  return arm;
}

/// Scenes by their drawing, so that equal ones are one.
class Scenes {
 public:
  std::size_t add(const RecordedScene& scene) {
    const auto [known, is_new] = numbers_.try_emplace(page::json_of(scene.objects), scenes_.size());
    if (is_new)
      scenes_.push_back({scene.objects, 0});
    ++scenes_[known->second].paths;
    return known->second;
  }

  /// Moves the scenes of most paths to the figure, and numbers those of its paths anew.
  void move_to(TaskPaths& figure) && {
    figure.scenes_known = scenes_.size();
    std::vector<std::size_t> order(scenes_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater{},
                             [this](std::size_t scene) { return scenes_[scene].paths; });
    std::vector<std::optional<std::size_t>> places(scenes_.size());
    std::size_t objects = 0;
    for (const std::size_t scene : order) {
      objects += scenes_[scene].objects.size();
      if (figure.scenes.size() == kMaxTaskScenes || objects > kMaxTaskObjects)
        break;
      places[scene] = figure.scenes.size();
      figure.scenes.push_back(std::move(scenes_[scene]));
    }
    for (TaskPath& path : figure.paths)
      if (path.scene)
        path.scene = places[*path.scene];
  }

 private:
  std::map<std::string, std::size_t> numbers_;
  std::vector<TaskScene> scenes_;
};

/// Sorts the robots by label, and numbers those of the paths anew.
void sort_robots(TaskPaths& figure) {
  std::vector<std::size_t> order(figure.robots.size()), places(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) {
    return std::pair(figure.robots[i].label, figure.robots[i].robot);
  });
  std::vector<TaskArm> sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    places[order[i]] = i;
    sorted.push_back(std::move(figure.robots[order[i]]));
  }
  figure.robots = std::move(sorted);
  for (TaskPath& path : figure.paths)
    path.robot = places[path.robot];
}

/// Adds a path. \return  whether it and its robot could be read.
bool add_path(const PathSummary& summary, const LookUp& look_up, DrawnRobots& robots,
              Scenes& scenes, TaskPaths& figure) {
  const DrawnRobot* const drawn = robots.find(summary.robot);
  if (drawn == nullptr)
    return false;
  try {
    const Attempt attempt = look_up.attempt(summary.report_uuid);
    const kinematics::Chain& chain = drawn->robot.chain;
    if (!attempt.path || attempt.path->dof() != chain.dof())
      return false;
    const auto T_task_base = attempt.T_task_base.value_or(Eigen::Isometry3d::Identity());
    TaskPath path{summary, 0, hand_of(*attempt.path, chain, T_task_base), {}};
    const auto known = std::ranges::find(figure.robots, summary.robot, &TaskArm::robot);
    path.robot = static_cast<std::size_t>(known - figure.robots.begin());
    if (known == figure.robots.end())
      figure.robots.push_back({summary.robot, summary.label,
                               arm_of(attempt.path->waypoints().col(0), chain, T_task_base)});
    if (attempt.scene)
      path.scene = scenes.add(*attempt.scene);
    figure.paths.push_back(std::move(path));
    return true;
  } catch (const Failure&) {
    return false;
  }
}

}  // namespace

std::vector<Eigen::Index> simplified(const Eigen::Matrix3Xd& way, double tolerance_m) {
  std::vector<bool> kept(static_cast<std::size_t>(way.cols()), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> open{{0, way.cols() - 1}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    Eigen::Index farthest = from;
    double most = tolerance_m;
    for (Eigen::Index i = from + 1; i < to; ++i)
      if (const double off = distance(way.col(i), way.col(from), way.col(to)); off > most) {
        most = off;
        farthest = i;
      }
    if (farthest == from)
      continue;
    kept[static_cast<std::size_t>(farthest)] = true;
    open.emplace_back(from, farthest);
    open.emplace_back(farthest, to);
  }
  std::vector<Eigen::Index> columns;
  for (Eigen::Index i = 0; i < way.cols(); ++i)
    if (kept[static_cast<std::size_t>(i)])
      columns.push_back(i);
  return columns;
}

TaskPaths task_paths(const TaskSummary& task, const LookUp& look_up) {
  TaskPaths figure;
  figure.in_use = task.paths;
  DrawnRobots robots(look_up);
  Scenes scenes;
  for (const PathSummary& summary : newest_paths(look_up, task.task, std::nullopt, kMaxTaskPaths)) {
    if (figure.paths.size() + figure.left_out == kMaxTaskPaths)
      break;
    if (summary.retired_ms == 0 && !add_path(summary, look_up, robots, scenes, figure))
      ++figure.left_out;
  }
  std::ranges::reverse(figure.paths);
  std::move(scenes).move_to(figure);
  sort_robots(figure);
  return figure;
}

namespace {

std::string json_of(const TaskPath& path) {
  const PlanningRecord& record = path.summary.record;
  return object({{"uuid", json_string(path.summary.report_uuid.text())},
                 {"robot", std::to_string(path.robot)},
                 {"received_ms", std::to_string(path.summary.received_ms)},
                 {"checks", std::to_string(record.collision_checks)},
                 {"time_s", number(record.planning_time_s)},
                 {"mode", json_string(to_text(record.sampling_mode))},
                 {"scene", path.scene ? std::to_string(*path.scene) : "null"},
                 {"hand", page::millimetres(path.hand)}});
}

std::string json_of(const TaskArm& robot) {
  return object({{"robot", json_string(robot.robot.hex())},
                 {"label", json_string(robot.label)},
                 {"arm", page::millimetres(robot.arm)}});
}

std::string json_of(const TaskScene& scene) {
  return object(
      {{"objects", page::json_of(scene.objects)}, {"paths", std::to_string(scene.paths)}});
}

}  // namespace

std::string to_json(const TaskPaths& paths) {
  return object(
      {{"in_use", std::to_string(paths.in_use)},
       {"robots", list(paths.robots, [](const TaskArm& robot) { return json_of(robot); })},
       {"paths", list(paths.paths, [](const TaskPath& path) { return json_of(path); })},
       {"scenes", list(paths.scenes, [](const TaskScene& scene) { return json_of(scene); })},
       {"scenes_known", std::to_string(paths.scenes_known)},
       {"left_out", std::to_string(paths.left_out)}});
}

}  // namespace kinship::plots
