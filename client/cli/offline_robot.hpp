#pragma once

#include <Eigen/Geometry>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/robot_check.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/robot_arguments.hpp"

/// A robot of the command line, without a server.
namespace kinship::cli {

/// Prints the warnings of reading a robot's files, a line each.
void print_warnings(const char* command, const std::vector<std::string>& warnings,
                    std::ostream& err);

/// The robot that the arguments describe, its warnings on `err`. Empty with an exit code in `code`
/// if there is none: wrong usage if the arguments are wrong, failed if Kinship cannot use the
/// robot.
std::optional<kinematics::RobotModel> read_robot(const char* command,
                                                 const models::RobotArguments& arguments,
                                                 std::ostream& err, int& code);

/// A robot's collision geometry: planning needs it, kinematics and the server do not.
/// \return empty if it is not known here, with the reason on `err`.
std::optional<geometry::RobotShapes> read_geometry(const char* command,
                                                   const models::RobotArguments& arguments,
                                                   const kinematics::RobotModel& robot,
                                                   std::ostream& err);

/// T_task_base of a --placement; empty if the text is.
Result<std::optional<Eigen::Isometry3d>> placement_of(const std::string& text);

/// The values of --q, joint units, separated by spaces.
Result<Eigen::VectorXd> parse_configuration(const std::string& text);

/// An error for another number of values than joints, or for values outside the limits.
std::optional<Error> check_configuration(const kinematics::Chain& chain, const Eigen::VectorXd& q);

/// Inverse kinematics, and the processor time that it took.
InverseAnswer solve(const inverse::Solver& solver, const Eigen::Isometry3d& T_base_tip,
                    const inverse::InverseOptions& options);

}  // namespace kinship::cli
