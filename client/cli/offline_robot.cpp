#include "client/cli/offline_robot.hpp"

#include <ctime>
#include <ostream>

#include "client/cli/admin_rows.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::cli {
namespace {

double cpu_time_s() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

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

std::optional<DescribedRobot> read_robot(const char* command,
                                         const models::RobotArguments& arguments, std::ostream& err,
                                         int& code) {
  auto description = models::describe_robot(arguments);
  if (!description) {
    code = refuse(command, description.error(), err);
    return std::nullopt;
  }
  auto chain = kinematics::read_chain(*description);
  if (!chain) {
    refuse(command, chain.error(), err);
    code = kFailed;
    return std::nullopt;
  }
  return DescribedRobot{*std::move(description), *std::move(chain)};
}

std::optional<geometry::RobotShapes> read_geometry(const char* command,
                                                   const models::RobotArguments& arguments,
                                                   const RobotDescription& description,
                                                   std::ostream& err) {
  const auto chain = kinematics::read_chain(description);
  if (!chain)
    return std::nullopt;
  auto shapes = models::load_shapes(arguments, description, *chain);
  if (shapes)
    return *std::move(shapes);
  err << command << ": without collision geometry: " << shapes.error().message << '\n';
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
