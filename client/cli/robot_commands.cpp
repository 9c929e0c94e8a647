#include "client/cli/robot_commands.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <random>

#include "client/cli/cell_text.hpp"
#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/value_text.hpp"
#include "proto/json/robot_answers_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/number_text.hpp"
#include "robots/collision/fitted_links.hpp"
#include "robots/collision/pair_sampling.hpp"
#include "robots/collision/robot_solids.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::cli {
namespace {

using tables::Table;

constexpr int kJointDigits = 4;

/// Warns of missing and implausible solids.
void warn_of_geometry(const char* command, const kinematics::Chain& chain,
                      const geometry::RobotShapes& shapes, std::ostream& err) {
  for (const std::string& doubt : geometry::find_doubts(chain, shapes))
    err << command << ": warning: " << doubt << '\n';
}

/// Adds the meshes that are here, or tells `err` why not.
void add_meshes(const char* command, const models::RobotArguments& arguments,
                kinematics::RobotModel& robot, std::ostream& err) {
  const auto notes = models::add_meshes(arguments, robot);
  if (!notes)
    err << command << ": no meshes: " << notes.error().message << '\n';
  else
    for (const std::string& note : *notes)
      err << command << ": " << note << '\n';
}

/// Adds solids around the meshes that are here, or tells `err` why not.
/// \return why the robot is not to be registered.
std::optional<Error> add_mesh_solids(const char* command, const models::RobotArguments& arguments,
                                     kinematics::RobotModel& robot, std::ostream& err) {
  const auto geometry = read_geometry(command, arguments, robot, err);
  if (!geometry)
    return std::nullopt;
  if (auto error = geometry::find_impossible_solids(robot.chain, *geometry))
    return error;
  warn_of_geometry(command, robot.chain, *geometry, err);
  auto fitted = collision::fit_robot(robot.chain, *geometry);
  if (fitted)
    robot.description.mesh_solids = std::move(fitted).value().mesh_solids;
  else
    err << command << ": no solids around its meshes: " << fitted.error().message << '\n';
  return std::nullopt;
}

const char* type_text(kinematics::JointType type) {
  switch (type) {
    case kinematics::JointType::Revolute:
      return "revolute";
    case kinematics::JointType::Continuous:
      return "continuous";
    default:
      return "prismatic";
  }
}

/// Solves poses that random configurations reach.
void measure(const CheckOptions& options, const kinematics::Chain& chain,
             const inverse::Solver& solver, RobotCheck& check) {
  std::mt19937_64 generator(options.seed);
  std::uniform_real_distribution<double> unit(0, 1);
  double time_us = 0;
  for (int i = 0; i < options.poses; ++i) {
    Eigen::VectorXd q(chain.dof());
    for (Eigen::Index joint = 0; joint < chain.dof(); ++joint)
      q(joint) =
          chain.lower()(joint) + unit(generator) * (chain.upper()(joint) - chain.lower()(joint));
    const InverseAnswer answer = solve(solver, kinematics::T_base_tip(chain, q),
                                       {.max_solutions = options.max_solutions,
                                        .min_distance = options.min_distance,
                                        .seed = options.seed + static_cast<std::uint64_t>(i)});
    time_us += answer.time_us;
    check.solutions_per_pose += static_cast<double>(answer.solutions.cols());
    if (answer.solutions.cols() == 0)
      ++check.poses_without_solution;
  }
  check.poses = static_cast<std::uint64_t>(options.poses);
  check.solutions_per_pose /= std::max(1, options.poses);
  check.time_per_pose_us = time_us / std::max(1, options.poses);
}

std::string geometry_text(const geometry::RobotShapes& geometry, std::size_t unchecked) {
  const auto around_meshes = static_cast<std::uint64_t>(
      std::ranges::count_if(geometry.shapes, &geometry::LinkShape::approximate));
  return count_text(geometry.shapes.size(), "shape") +
         (around_meshes > 0 ? ", " + std::to_string(around_meshes) + " of them around meshes"
                            : "") +
         "; " + count_text(unchecked, "pair") +
         " of links never checked against each other ('kinship robots links' names them)";
}

/// The solids that a server can filter with for a robot with meshes, and their agreement.
void print_filter(const collision::FittedRobot& fitted, std::ostream& out) {
  const collision::FilterAgreement& agreement = fitted.agreement;
  out << "server      gets " << count_text(fitted.mesh_solids.solids.size(), "solid")
      << " around the meshes, which find " << agreement.found << " of " << agreement.colliding
      << " self-collisions and take " << agreement.lost << " of " << agreement.free
      << " free configurations for some; "
      << count_text(fitted.mesh_solids.unfiltered.size(), "pair") << " of links not compared\n";
}

std::vector<CheckedLink> checked_links(const kinematics::Chain& chain,
                                       const geometry::RobotShapes& shapes) {
  std::vector<CheckedLink> links;
  for (const geometry::LinkExtent& extent : geometry::link_extents(chain, shapes))
    links.push_back({extent.link, extent.solids, extent.size_m.x(), extent.size_m.y(),
                     extent.size_m.z(), geometry::to_text(extent.from)});
  return links;
}

/// The box around a link's solids.
std::string extent_text(const CheckedLink& link) {
  constexpr int kDigits = 3;
  if (link.solids == 0)
    return "-";
  return number_text(link.size_x_m, kDigits) + " x " + number_text(link.size_y_m, kDigits) + " x " +
         number_text(link.size_z_m, kDigits);
}

void print_checked_links(const std::vector<CheckedLink>& links, std::ostream& out) {
  Table table({"LINK", "SOLIDS", "EXTENT M", "FROM"});
  for (const CheckedLink& link : links)
    table.add_row({link.link, std::to_string(link.solids), extent_text(link), link.from});
  table.print(out);
}

/// "rod (-0.5 joint_2 + 0.1)".
std::string mimic_text(const kinematics::Chain& chain, const kinematics::MimicJoint& mimic) {
  std::string text = mimic.joint.name + " (" + kinship::number_text(mimic.multiplier) + " " +
                     chain.joints()[static_cast<std::size_t>(mimic.source)].name;
  if (mimic.offset != 0)
    text += (mimic.offset < 0 ? " - " : " + ") + kinship::number_text(std::abs(mimic.offset));
  return text + ")";
}

/// The joints that move with the chain beside it.
void print_mimics(const kinematics::Chain& chain, std::ostream& out) {
  std::string text;
  for (const kinematics::MimicJoint& mimic : chain.mimics())
    text += (text.empty() ? "" : ", ") + mimic_text(chain, mimic);
  if (!text.empty())
    out << "followed by " << text << '\n';
}

void print_check(const RobotCheck& check, const kinematics::Chain& chain,
                 const RobotDescription& description, const std::string& geometry,
                 std::ostream& out) {
  out << "robot       " << check.robot.hex() << '\n'
      << "chain       " << check.base_link << " -> " << check.tip_link << ", "
      << check.joints.size() << " joints\n";
  print_mimics(chain, out);
  print_transfer(description, out);
  out << "reach       " << number_text(check.reach_m, 3) << " m to the tip link, stretched out; "
      << number_text(check.transfer_distance_m, 3) << " m from there to the transfer frame\n"
      << "geometry    " << geometry << '\n'
      << "structure   " << check.structure << '\n'
      << "solver      " << check.solver << '\n'
      << "inverse     " << number_text(check.solutions_per_pose, 2) << " solutions and "
      << number_text(check.time_per_pose_us, 1) << " us (CPU) per reachable pose; "
      << check.poses_without_solution << " of " << check.poses << " poses without a solution\n\n";
  Table table({"JOINT", "TYPE", "LOWER", "UPPER"});
  for (const CheckedJoint& joint : check.joints)
    table.add_row({joint.name, joint.type, number_text(joint.lower, kJointDigits),
                   number_text(joint.upper, kJointDigits)});
  table.print(out);
  if (!check.links.empty()) {
    out << '\n';
    print_checked_links(check.links, out);
  }
}

/// Of a bare URDF: by default poses are of the tip link itself.
void warn_without_transfer(const char* command, const models::RobotArguments& arguments,
                           const RobotDescription& description, std::ostream& err) {
  if (models::says_transfer(arguments))
    return;
  err << command << ": without --transfer goals mean the tip link '" << description.tip_link
      << "' itself; if it holds a tool, say where that is in the tip link: --transfer \"x y z qx "
         "qy "
         "qz qw\" ('kinship robots frames' shows it)\n";
}

/// Links that touch wherever the robot goes: they are not checked, but are where pairs are named,
/// for then all others are.
void warn_of_touching(const char* command, const collision::RobotSolids& solids,
                      std::ostream& err) {
  const kinematics::Chain& chain = solids.parts().chain;
  if (const std::string touching = collision::describe_always_touching(solids); !touching.empty())
    err << command << ": warning: " << touching << '\n';
  for (const auto& [a, b] :
       collision::links_always_touching(solids.parts(), collision::kLinkSamples))
    err << command << ": '" << chain.links()[static_cast<std::size_t>(a)].name << "' and '"
        << chain.links()[static_cast<std::size_t>(b)].name
        << "' touch in nearly every configuration and are checked, so nothing can be planned: "
           "'kinship robots suggest-srdf' makes an SRDF that excepts them\n";
}

void print_same_arms(const std::vector<std::string>& labels, std::ostream& out) {
  if (labels.empty())
    return;
  out << "the same arm as";
  for (std::size_t i = 0; i < labels.size(); ++i)
    out << (i == 0 ? " " : ", ") << labels[i];
  out << ": experience passes between them as it is\n";
}

}  // namespace

int check_robot(const CheckOptions& options, std::ostream& out, std::ostream& err) {
  int code = kDone;
  constexpr const char* kCommand = "robots check";
  const auto robot = read_robot(kCommand, options.robot, err, code);
  if (!robot)
    return code;
  const kinematics::Chain& chain = robot->chain;
  const auto geometry = read_geometry(kCommand, options.robot, *robot, err);
  warn_without_transfer(kCommand, options.robot, robot->description, err);
  RobotCheck check;
  std::string geometry_words = "not known";
  if (geometry) {
    warn_of_geometry(kCommand, chain, *geometry, err);
    const collision::RobotSolids solids(chain, *geometry);
    warn_of_touching(kCommand, solids, err);
    geometry_words = geometry_text(*geometry, solids.parts().unchecked.size());
    check.links = checked_links(chain, *geometry);
  }
  check.robot = chain.digest();
  check.base_link = chain.base_link();
  check.tip_link = chain.tip_link();
  check.reach_m = geometry::reach_m(chain);
  check.transfer_distance_m = geometry::transfer_distance_m(chain);
  check.structure = inverse::describe_structure(chain);
  const inverse::Solver solver(chain);
  check.solver = solver.name();
  for (const kinematics::Joint& joint : chain.joints())
    check.joints.push_back({joint.name, type_text(joint.type), joint.lower, joint.upper});
  measure(options, chain, solver, check);
  if (options.json)
    out << json::to_json(check) << '\n';
  else
    print_check(check, chain, robot->description, geometry_words, out);
  if (!geometry)
    return kDone;
  if (const auto error = geometry::find_impossible_solids(chain, *geometry))
    return refuse(kCommand, *error, err);
  if (options.json)
    return kDone;
  const auto fitted = collision::fit_robot(chain, *geometry);
  if (fitted && !fitted->mesh_solids.solids.empty())
    print_filter(*fitted, out);
  return kDone;
}

int register_robot(link::Client& server, const models::RobotArguments& arguments, bool json,
                   std::ostream& out, std::ostream& err) {
  constexpr const char* kCommand = "robots register";
  auto described = models::describe_robot(arguments);
  if (!described)
    return refuse(kCommand, described.error(), err);
  print_warnings(kCommand, described->warnings, err);
  auto read = models::read_model(*std::move(described));
  if (!read)
    return refuse(kCommand, read.error(), err);
  kinematics::RobotModel robot = *std::move(read);
  const RobotDescription& description = robot.description;
  warn_without_transfer(kCommand, arguments, description, err);
  if (const auto error = add_mesh_solids(kCommand, arguments, robot, err))
    return refuse(kCommand, *error, err);
  add_meshes(kCommand, arguments, robot, err);
  const auto reply = server.register_robot(description);
  if (!reply)
    return refuse(kCommand, reply.error(), err);
  if (reply->status == RegisterStatus::Refused) {
    err << kCommand << ": refused: " << reply->message << '\n';
    return kWrongUsage;
  }
  if (!reply->message.empty())
    err << kCommand << ": " << reply->message << "; the label '" << description.label
        << "' is not kept\n";
  if (json)
    out << json::to_json(*reply, description.label) << '\n';
  else
    out << (reply->message.empty() ? description.label + " is " : "") << "robot "
        << reply->robot.short_hex() << ": " << reply->dof << " joints, " << reply->solver
        << (reply->status == RegisterStatus::Known ? " (known already)" : "") << '\n';
  if (!json && !reply->geometry.empty())
    out << (reply->took_geometry ? "better geometry than before, it counts from now on: "
                                 : "the server filters with: ")
        << reply->geometry << '\n';
  if (!json && !description.meshes.empty())
    out << "meshes: " << (reply->meshes.empty() ? "the server takes none" : reply->meshes) << '\n';
  if (!json)
    print_same_arms(reply->same_arms, out);
  return kDone;
}

}  // namespace kinship::cli
