#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "proto/types/task_axes.hpp"
#include "robots/collision/fitted_links.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::c_library {
namespace {

/// "x,y,yaw" as axes. \throws Failure(InvalidInput) that names a word that is none.
TaskAxes read_axes(const char* text) {
  std::vector<std::string_view> names;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    names.push_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return parse_task_axes(names).value_or_throw();
}

std::map<std::string, double> read_held(const kinship_held_joint* joints, std::size_t count) {
  if (count > 0)
    require(joints, "held_joints");
  std::map<std::string, double> held;
  for (std::size_t i = 0; i < count; ++i) {
    require(joints[i].name, "a name in held_joints");
    held[joints[i].name] = joints[i].value;
  }
  return held;
}

RobotDescription read_description(const kinship_robot_description& given) {
  require(given.urdf, "description->urdf");
  require(given.base_link, "description->base_link");
  require(given.tip_link, "description->tip_link");
  require(given.label, "description->label");
  RobotDescription description;
  description.label = given.label;
  description.urdf = given.urdf;
  description.base_link = given.base_link;
  description.tip_link = given.tip_link;
  if (given.T_tip_transfer != nullptr)
    description.T_tip_transfer = read_pose(given.T_tip_transfer, "description->T_tip_transfer");
  if (given.axes != nullptr)
    description.task_axes = read_axes(given.axes);
  description.held_joints = read_held(given.held_joints, given.held_joint_count);
  description.never_colliding = read_pairs(given.never_colliding, given.never_colliding_pairs,
                                           "description->never_colliding");
  return description;
}

std::vector<std::string> read_texts(const char* const* texts, std::size_t count,
                                    const std::string& name) {
  if (count > 0)
    require(texts, name.c_str());
  std::vector<std::string> read;
  for (std::size_t i = 0; i < count; ++i) {
    require(texts[i], ("a text in " + name).c_str());
    read.emplace_back(texts[i]);
  }
  return read;
}

models::RobotArguments read_file_arguments(const kinship_robot_file& given) {
  require(given.source, "file->source");
  models::RobotArguments arguments;
  arguments.source = given.source;
  arguments.base_link = text_or_empty(given.base_link);
  arguments.tip_link = text_or_empty(given.tip_link);
  arguments.label = text_or_empty(given.label);
  arguments.axes = text_or_empty(given.axes);
  arguments.srdf = text_or_empty(given.srdf);
  arguments.packages = read_texts(given.packages, given.package_count, "file->packages");
  arguments.collision_from_visual = given.collision_from_visual != 0;
  arguments.without_meshes = given.without_meshes != 0;
  arguments.without_collision =
      read_texts(given.without_collision, given.without_collision_count, "file->without_collision");
  arguments.xacro = read_texts(given.xacro, given.xacro_count, "file->xacro");
  return arguments;
}

/// With its meshes, and solids around them, if it has any.
kinematics::RobotModel read_file(const kinship_robot_file& given) {
  models::LoadedRobot robot = read_robot_file(given);
  kinematics::RobotModel& model = robot;
  model.description.mesh_solids =
      collision::fit_robot(robot.chain, robot.shapes).value_or_throw().mesh_solids;
  static_cast<void>(models::add_meshes(read_file_arguments(given), model).value_or_throw());
  return model;
}

kinship_code register_with(kinship_client& client, const kinematics::RobotModel& model,
                           kinship_robot& robot, size_t* dof) {
  const Digest digest = model.chain.digest();
  std::ranges::copy(digest.bytes, robot.digest);
  if (dof != nullptr)
    *dof = static_cast<size_t>(model.chain.dof());
  client.keep(model.chain);
  const auto reply = client.line.register_robot(model);
  if (!reply)
    return remember(reply.error());
  return reply->status == RegisterStatus::Refused ? remember(KINSHIP_REFUSED, reply->message)
                                                  : KINSHIP_OK;
}

}  // namespace

models::LoadedRobot read_robot_file(const kinship_robot_file& given) {
  const models::RobotArguments arguments = read_file_arguments(given);
  models::DescribedRobot described = models::describe_robot(arguments).value_or_throw();
  RobotDescription& description = described.description;
  if (given.T_tip_transfer != nullptr)
    description.T_tip_transfer = read_pose(given.T_tip_transfer, "file->T_tip_transfer");
  for (const auto& [joint, value] : read_held(given.held_joints, given.held_joint_count))
    description.held_joints[joint] = value;
  std::vector<std::string> warnings = std::move(described.warnings);
  const std::optional<double> limit_slack = described.limit_slack;
  kinematics::RobotModel model = models::read_model(std::move(described)).value_or_throw();
  geometry::RobotShapes shapes = models::load_shapes(arguments, model).value_or_throw();
  return {std::move(model), std::move(shapes), std::move(warnings), limit_slack};
}

}  // namespace kinship::c_library

using namespace kinship::c_library;

kinship_code kinship_register(kinship_client* client, const kinship_robot_description* description,
                              kinship_robot* robot, size_t* dof) {
  return guarded([&] {
    require(client, "client");
    require(robot, "robot");
    return register_with(*client,
                         kinship::kinematics::read_model(
                             read_description(read_structure(description, "description")))
                             .value_or_throw(),
                         *robot, dof);
  });
}

kinship_code kinship_register_file(kinship_client* client, const kinship_robot_file* file,
                                   kinship_robot* robot, size_t* dof) {
  return guarded([&] {
    require(client, "client");
    require(robot, "robot");
    const kinship_robot_file given = read_structure(file, "file");
    const kinship::kinematics::RobotModel model = read_file(given);
    if (given.without_meshes != 0)
      client->line.forget_meshes(model.chain.digest());
    return register_with(*client, model, *robot, dof);
  });
}
