#include "client/cli/offline_robot.hpp"

#include <ctime>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::cli {
namespace {

double cpu_time_s() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

constexpr int kValueDigits = 4;

const char* reason_text(inverse::NoSolution reason) {
  switch (reason) {
    case inverse::NoSolution::OutOfReach:
      return "out_of_reach";
    case inverse::NoSolution::Limits:
      return "limits";
    case inverse::NoSolution::NotConverged:
      return "not_converged";
    default:
      return "";
  }
}

}  // namespace

void print_warnings(const char* command, const std::vector<std::string>& warnings,
                    std::ostream& err) {
  for (const std::string& warning : warnings)
    err << command << ": warning: " << warning << '\n';
}

std::optional<kinematics::RobotModel> read_robot(const char* command,
                                                 const models::RobotArguments& arguments,
                                                 std::ostream& err, int& code) {
  auto described = models::describe_robot(arguments);
  if (!described) {
    code = refuse(command, described.error(), err);
    return std::nullopt;
  }
  print_warnings(command, described->warnings, err);
  auto robot = models::read_model(*std::move(described));
  if (!robot) {
    refuse(command, robot.error(), err);
    code = kFailed;
    return std::nullopt;
  }
  return *std::move(robot);
}

std::optional<geometry::RobotShapes> read_geometry(const char* command,
                                                   const models::RobotArguments& arguments,
                                                   const kinematics::RobotModel& robot,
                                                   std::ostream& err) {
  auto shapes = models::load_shapes(arguments, robot);
  if (shapes)
    return *std::move(shapes);
  err << command << ": without collision geometry: " << shapes.error().message << '\n';
  return std::nullopt;
}

Result<std::optional<Eigen::Isometry3d>> placement_of(const std::string& text) {
  if (text.empty())
    return std::optional<Eigen::Isometry3d>();
  const auto pose = models::parse_pose(text);
  if (!pose)
    return Error{pose.error().code, "--placement: " + pose.error().message};
  return std::optional(*pose);
}

Result<Eigen::VectorXd> parse_configuration(const std::string& text) {
  const auto values = models::parse_numbers(text);
  if (!values)
    return Error{values.error().code, "--q: " + values.error().message};
  return Eigen::VectorXd(
      Eigen::Map<const Eigen::VectorXd>(values->data(), static_cast<Eigen::Index>(values->size())));
}

std::optional<Error> check_configuration(const kinematics::Chain& chain, const Eigen::VectorXd& q) {
  if (q.size() != chain.dof())
    return Error{ErrorCode::InvalidInput, "a configuration of " + std::to_string(q.size()) +
                                              " values, but the robot has " +
                                              std::to_string(chain.dof()) + " joints"};
  for (Eigen::Index joint = 0; joint < q.size(); ++joint)
    if (!(q(joint) >= chain.lower()(joint) && q(joint) <= chain.upper()(joint)))
      return Error{ErrorCode::InvalidInput,
                   "joint '" + chain.joints()[static_cast<std::size_t>(joint)].name + "' at " +
                       number_text(q(joint), kValueDigits) + " is outside " +
                       number_text(chain.lower()(joint), kValueDigits) + " to " +
                       number_text(chain.upper()(joint), kValueDigits)};
  return std::nullopt;
}

InverseAnswer solve(const inverse::Solver& solver, const Eigen::Isometry3d& T_base_tip,
                    const inverse::InverseOptions& options) {
  InverseAnswer answer;
  answer.solver = solver.name();
  const double start_s = cpu_time_s();
  const inverse::InverseSolutions solutions = solver.solve(T_base_tip, options);
  answer.time_us = 1e6 * (cpu_time_s() - start_s);
  answer.solutions = solutions.configurations;
  answer.reason = reason_text(solutions.reason);
  return answer;
}

}  // namespace kinship::cli
