#include "client/cli/kinematics_commands.hpp"

#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <sstream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "proto/files/lines.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/json/robot_answers_json.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/models/mesh_files.hpp"

namespace kinship::cli {
namespace {

constexpr int kDigitsOfJoint = 4;
constexpr const char* kForward = "robots fk";
constexpr const char* kInverse = "robots ik";

Error in_line(const std::filesystem::path& file, std::size_t number, const Error& error) {
  return {error.code,
          "'" + file.string() + "' line " + std::to_string(number) + ": " + error.message};
}

void print_forward(const ForwardAnswer& answer, bool json, std::ostream& out) {
  if (json) {
    out << json::to_json(answer) << '\n';
    return;
  }
  const char* const frame = answer.is_in_task ? " in task frame\n" : " in base link\n";
  out << "tip         " << pose_text(answer.tip) << frame << "transfer    "
      << pose_text(answer.transfer) << frame;
}

/// The world that solutions must not touch, or come near to, as kinship-plan has it.
struct CheckedWorld {
  CheckedWorld(const kinematics::RobotModel& robot, const geometry::RobotShapes& shapes,
               const collision::Surroundings& surroundings)
      : world(robot.chain, shapes, surroundings), prover(world) {}
  collision::CollisionWorld world;
  collision::EdgeProver prover;
};

/// Leaves out solutions in which the robot touches something, or comes too near to it.
void leave_out_colliding(collision::EdgeProver& prover, double clearance_m, InverseAnswer& answer) {
  Eigen::MatrixXd free(answer.solutions.rows(), answer.solutions.cols());
  Eigen::Index kept = 0;
  for (Eigen::Index column = 0; column < answer.solutions.cols(); ++column)
    if (prover.clear_ahead(answer.solutions.col(column), {clearance_m}) == 1)
      free.col(kept++) = answer.solutions.col(column);
  answer.colliding = static_cast<std::uint64_t>(answer.solutions.cols() - kept);
  if (kept == 0 && answer.solutions.cols() > 0)
    answer.reason = "colliding";
  answer.solutions = free.leftCols(kept).eval();
}

void print_inverse(const InverseAnswer& answer, bool json, std::ostream& out) {
  if (json) {
    out << json::to_json(answer) << '\n';
    return;
  }
  out << answer.solver << ": " << answer.solutions.cols() << " solutions in "
      << number_text(answer.time_us, 0) << " us";
  if (!answer.reason.empty())
    out << " (" << answer.reason << ')';
  if (answer.colliding.value_or(0) > 0)
    out << ", " << *answer.colliding << " left out that collide";
  out << '\n';
  for (Eigen::Index column = 0; column < answer.solutions.cols(); ++column) {
    for (Eigen::Index joint = 0; joint < answer.solutions.rows(); ++joint)
      out << (joint == 0 ? "  " : " ")
          << number_text(answer.solutions(joint, column), kDigitsOfJoint);
    out << '\n';
  }
}

/// The surroundings of the robot in the first problem of a file.
Result<collision::Surroundings> read_surroundings(const InverseCommandOptions& options) {
  collision::Surroundings surroundings;
  if (options.scene.empty())
    return surroundings;
  std::ifstream stream = files::open_input(options.scene);
  std::optional<Result<Problem>> problem;
  files::for_each_line(stream, options.scene.string(), [&](const files::Line& line) {
    problem = line.text ? json::problem_from_json(*line.text)
                        : Result<Problem>(in_line(options.scene, line.number, line.text.error()));
    return false;
  });
  if (!problem)
    return Error{ErrorCode::InvalidInput, "'" + options.scene.string() + "' holds no problem"};
  if (!*problem)
    return Error{problem->error().code,
                 "--scene '" + options.scene.string() + "': " + problem->error().message};
  const auto packages = models::packages_of(options.robot);
  if (!packages)
    return packages.error();
  Problem first = **problem;
  models::SceneMeshes meshes(options.scene.parent_path(), *packages);
  if (const auto error = meshes.read(first.scene, first.attached))
    return *error;
  surroundings.T_task_base = first.T_task_base.value_or(Eigen::Isometry3d::Identity());
  surroundings.scene = std::move(first.scene);
  surroundings.attached = std::move(first.attached);
  surroundings.allowed_collisions = std::move(first.allowed_collisions);
  return surroundings;
}

/// The world not to be touched; none unless it was asked for, or with an exit code in `code`.
std::unique_ptr<CheckedWorld> make_world(const InverseCommandOptions& options,
                                         const kinematics::RobotModel& robot, std::ostream& err,
                                         int& code) {
  if (!options.collision_free)
    return nullptr;
  const auto geometry = read_geometry(kInverse, options.robot, robot, err);
  if (!geometry) {
    code = kFailed;
    return nullptr;
  }
  const auto surroundings = read_surroundings(options);
  if (!surroundings) {
    code = refuse(kInverse, surroundings.error(), err);
    return nullptr;
  }
  return std::make_unique<CheckedWorld>(robot, *geometry, *surroundings);
}

/// Calls `use` with each line's value; a broken line ends it. \return an exit code.
template <typename Value>
int for_each_value(const std::filesystem::path& file, const char* command, std::ostream& err,
                   Result<Value> (*parse)(std::string_view),
                   const std::function<std::optional<Error>(const Value&)>& use) {
  int code = kDone;
  std::ifstream stream = files::open_input(file);
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    const Result<Value> value = line.text ? parse(*line.text) : line.text.error();
    const std::optional<Error> error = value ? use(*value) : std::optional(value.error());
    if (error)
      code = refuse(command, in_line(file, line.number, *error), err);
    return !error;
  });
  return code;
}

}  // namespace

int place_configurations(const ForwardCommandOptions& options, std::ostream& out,
                         std::ostream& err) {
  int code = kDone;
  const auto robot = read_robot(kForward, options.robot, err, code);
  if (!robot)
    return code;
  const auto placement = placement_of(options.placement);
  if (!placement)
    return refuse(kForward, placement.error(), err);
  const auto place = [&](const Eigen::VectorXd& q) -> std::optional<Error> {
    if (const auto fault = check_configuration(robot->chain, q))
      return fault;
    const Eigen::Isometry3d T_base_tip = kinematics::T_base_tip(robot->chain, q);
    const Eigen::Isometry3d T_frame_base = placement->value_or(Eigen::Isometry3d::Identity());
    print_forward({.q = q,
                   .is_in_task = placement->has_value(),
                   .tip = T_frame_base * T_base_tip,
                   .transfer = T_frame_base * T_base_tip * robot->description.T_tip_transfer},
                  options.json, out);
    return std::nullopt;
  };
  if (!options.configurations.empty())
    return for_each_value<Eigen::VectorXd>(options.configurations, kForward, err,
                                           json::configuration_from_json, place);
  const auto q = parse_configuration(options.configuration);
  const std::optional<Error> error = q ? place(*q) : std::optional(q.error());
  return error ? refuse(kForward, *error, err) : kDone;
}

int solve_poses(const InverseCommandOptions& options, std::ostream& out, std::ostream& err) {
  int code = kDone;
  if (!options.scene.empty() && !options.collision_free) {
    err << kInverse << ": --scene needs --collision-free\n";
    return kWrongUsage;
  }
  const auto robot = read_robot(kInverse, options.robot, err, code);
  if (!robot)
    return code;
  const auto placement = placement_of(options.placement);
  if (!placement)
    return refuse(kInverse, placement.error(), err);
  const auto world = make_world(options, *robot, err, code);
  if (code != kDone)
    return code;
  const inverse::Solver solver(robot->chain);
  const inverse::InverseOptions inverse_options = {.max_solutions = options.max_solutions,
                                                   .min_distance = options.min_distance,
                                                   .seed = options.seed};
  const Eigen::Isometry3d T_frame_tip = options.frame == "transfer"
                                            ? robot->description.T_tip_transfer.inverse()
                                            : Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d T_base_task =
      placement->value_or(Eigen::Isometry3d::Identity()).inverse();
  const auto answer_one = [&](const Eigen::Isometry3d& pose) -> std::optional<Error> {
    const Eigen::Isometry3d T_base_tip = T_base_task * pose * T_frame_tip;
    InverseAnswer answer = solve(solver, T_base_tip, inverse_options);
    if (const std::string far = geometry::describe_far_place(
            robot->chain, (T_base_tip * robot->description.T_tip_transfer).translation());
        !far.empty())
      err << kInverse << ": warning: " << far << '\n';
    if (world)
      leave_out_colliding(world->prover, options.clearance_m, answer);
    print_inverse(answer, options.json, out);
    return std::nullopt;
  };
  if (!options.poses.empty())
    return for_each_value<Eigen::Isometry3d>(options.poses, kInverse, err, json::pose_from_json,
                                             answer_one);
  const auto pose = models::parse_pose(options.pose);
  const std::optional<Error> error = pose ? answer_one(*pose) : std::optional(pose.error());
  return error ? refuse(kInverse, *error, err) : kDone;
}

}  // namespace kinship::cli
