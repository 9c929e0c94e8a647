#include "robots/models/robot_arguments.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/pose.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/geometry/srdf.hpp"
#include "robots/models/mesh_files.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos)
      break;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return parts;
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    return std::nullopt;
  return value;
}

/// Appends what is named by the part before `sign` and not named yet.
void add_named(const std::vector<std::string>& more, std::string_view sign,
               std::vector<std::string>& all) {
  for (const std::string& each : more) {
    const std::string name = each.substr(0, each.find(sign) + sign.size());
    if (std::ranges::none_of(all, [&](const std::string& one) { return one.starts_with(name); }))
      all.push_back(each);
  }
}

/// Fills in what the arguments do not say.
void complete(const ChainFile& chain, RobotArguments& arguments) {
  const auto fill = [](const auto& value, auto& argument) {
    if (argument.empty())
      argument = value;
  };
  arguments.source = chain.urdf;
  fill(chain.base_link, arguments.base_link);
  fill(chain.tip_link, arguments.tip_link);
  fill(chain.label, arguments.label);
  fill(chain.srdf, arguments.srdf);
  std::vector<std::string> packages;
  for (const auto& [name, folder] : chain.packages)
    packages.push_back(name + "=" + folder.string());
  add_named(packages, "=", arguments.packages);
  add_named(chain.xacro, ":=", arguments.xacro);
  arguments.mesh_folders.insert(arguments.mesh_folders.end(), chain.mesh_folders.begin(),
                                chain.mesh_folders.end());
  arguments.collision_from_visual = arguments.collision_from_visual || chain.collision_from_visual;
  arguments.without_collision.insert(arguments.without_collision.end(),
                                     chain.without_collision.begin(),
                                     chain.without_collision.end());
  if (!arguments.limit_slack)
    arguments.limit_slack = chain.limit_slack;
}

/// \throws Failure with the fault.
void add_held_joint(std::string_view text, RobotDescription& description) {
  const std::size_t equals = text.rfind('=');
  const auto value =
      equals == std::string_view::npos ? std::nullopt : parse_number(text.substr(equals + 1));
  if (equals == 0 || !value)
    throw Failure(ErrorCode::InvalidInput,
                  "--hold '" + std::string(text) + "': must be JOINT=VALUE");
  description.held_joints[std::string(text.substr(0, equals))] = *value;
}

/// \throws Failure with the fault.
void replace_frame_and_axes(const RobotArguments& arguments, RobotDescription& description) {
  if (!arguments.transfer.empty()) {
    const auto pose = parse_pose(arguments.transfer);
    if (!pose)
      throw Failure(pose.error().code, "--transfer: " + pose.error().message);
    description.T_tip_transfer = *pose;
  }
  if (!arguments.axes.empty()) {
    const auto axes = parse_task_axes(split(arguments.axes, " ,"));
    if (!axes)
      throw Failure(axes.error().code, "--axes: " + axes.error().message);
    description.task_axes = *axes;
  }
}

/// "arm.srdf: the robot has no link 'camera' (line 2): 3 pairs that name it are left out"
std::string stranger_warning(const std::filesystem::path& srdf,
                             const geometry::SrdfStranger& stranger) {
  return srdf.string() + ": the robot has no link '" + on_one_line(stranger.link) + "' (line " +
         std::to_string(stranger.line) + "): " +
         (stranger.pairs == 1 ? "a pair that names it is"
                              : std::to_string(stranger.pairs) + " pairs that name it are") +
         " left out";
}

/// \throws Failure with the fault.
void add_pairs(const RobotArguments& arguments, DescribedRobot& robot) {
  const std::filesystem::path& srdf = arguments.srdf;
  const std::string text = read_expanded(
      srdf,
      {.arguments = arguments.xacro, .max_bytes = geometry::kMaxSrdfBytes, .ending = ".srdf"});
  kinematics::RobotModel model = kinematics::read_model(robot.description).value_or_throw();
  robot.urdf = std::move(model.urdf);
  std::vector<geometry::SrdfStranger> strangers;
  const auto pairs = geometry::read_srdf(text, model.chain, &strangers);
  if (!pairs)
    throw Failure(pairs.error().code, srdf.string() + ": " + pairs.error().message);
  if (pairs->empty() && strangers.empty())
    throw Failure(ErrorCode::InvalidInput,
                  srdf.string() +
                      ": has no disable_collisions element, so it says nothing of this robot; "
                      "'kinship robots suggest-srdf' makes one that does");
  for (const geometry::SrdfStranger& stranger : strangers)
    robot.warnings.push_back(stranger_warning(srdf, stranger));
  auto& all = robot.description.never_colliding;
  all.insert(all.end(), pairs->begin(), pairs->end());
  if (all.size() > kMaxCollisionPairs)
    throw Failure(ErrorCode::TooLarge,
                  srdf.string() + ": with the folder's " + std::to_string(all.size()) +
                      " never-colliding pairs exceed " + std::to_string(kMaxCollisionPairs));
}

/// Why a robot's base and tip must be given.
Error missing_ends(const std::string& file) {
  return invalid_input("'" + file +
                       "' is a URDF file: needs --base LINK and --tip LINK (or give a model "
                       "folder: 'kinship robots init " +
                       file + "' makes one); 'kinship robots links " + file +
                       "' shows its links and which could be these");
}

/// \throws Failure with the fault.
DescribedRobot put_together(const RobotArguments& given) {
  const ResolvedArguments resolved = resolve(given).value_or_throw();
  const RobotArguments& arguments = resolved.arguments;
  DescribedRobot robot;
  robot.limit_slack = arguments.limit_slack;
  RobotDescription& description = robot.description;
  description.urdf = read_expanded(arguments.source, urdf_input(arguments));
  if (arguments.base_link.empty() || arguments.tip_link.empty())
    throw Failure(missing_ends(arguments.source.string()));
  description.base_link = arguments.base_link;
  description.tip_link = arguments.tip_link;
  description.label = arguments.label.empty() ? label_of(arguments.source) : arguments.label;
  if (arguments.label.empty())
    if (const auto error = check_label(description.label))
      throw Failure(error->code, "the robot's name is that of its file, and " + error->message +
                                     "; give another one with --label");
  if (resolved.chain) {
    description.T_tip_transfer = resolved.chain->T_tip_transfer;
    description.task_axes = resolved.chain->task_axes;
    description.held_joints = resolved.chain->held;
    description.never_colliding = resolved.chain->never_colliding;
  }
  parse_packages(arguments.packages).value_or_throw();
  if (arguments.collision_from_visual)
    description.urdf = geometry::with_visual_solids(description.urdf, arguments.without_collision)
                           .value_or_throw();
  replace_frame_and_axes(arguments, description);
  for (const std::string& held : arguments.held)
    add_held_joint(held, description);
  if (!arguments.srdf.empty())
    add_pairs(arguments, robot);
  return robot;
}

}  // namespace

std::string label_of(const std::filesystem::path& urdf) {
  std::filesystem::path name = urdf.filename();
  if (name.extension() == ".xacro")
    name.replace_extension();
  return name.stem().string();
}

XacroInput urdf_input(const RobotArguments& arguments) {
  return {.arguments = arguments.xacro, .max_bytes = kMaxUrdfBytes, .ending = ".urdf"};
}

Result<ResolvedArguments> resolve(RobotArguments arguments) {
  arguments.source = place_of_robot(arguments.source);
  if (!is_model_folder(arguments.source))
    return ResolvedArguments{std::move(arguments), std::nullopt};
  auto chain = read_chain_file(arguments.source);
  if (!chain)
    return chain.error();
  complete(*chain, arguments);
  return ResolvedArguments{std::move(arguments), *std::move(chain)};
}

Result<RobotDescription> read_model_folder(const std::filesystem::path& folder) {
  auto robot = describe_robot({.source = folder});
  if (!robot)
    return robot.error();
  return std::move(robot)->description;
}

Result<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view part : split(text, " ,\t")) {
    const auto value = parse_number(part);
    if (!value)
      return invalid_input("'" + std::string(text) + "': '" + std::string(part) + "' is no number");
    numbers.push_back(*value);
  }
  if (numbers.empty())
    return invalid_input("'" + std::string(text) + "': no number");
  return numbers;
}

Result<Eigen::Isometry3d> parse_pose(std::string_view text) {
  const auto numbers = parse_numbers(text);
  if (!numbers)
    return invalid_input("pose " + numbers.error().message);
  PoseArray pose{};
  if (numbers->size() != pose.size())
    return invalid_input("pose '" + std::string(text) + "': has " +
                         std::to_string(numbers->size()) +
                         " numbers, must be 7: x y z qx qy qz qw");
  std::ranges::copy(*numbers, pose.begin());
  return from_pose_array(pose);
}

bool says_transfer(const RobotArguments& arguments) {
  return !arguments.transfer.empty() || is_model_folder(place_of_robot(arguments.source));
}

Result<DescribedRobot> describe_robot(const RobotArguments& arguments) {
  try {
    return put_together(arguments);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

Result<kinematics::RobotModel> read_model(DescribedRobot robot) {
  auto model = kinematics::read_model(std::move(robot.description), std::move(robot.urdf));
  if (model)
    if (const auto error = geometry::find_impossible_lengths(model->chain))
      return *error;
  return model;
}

}  // namespace kinship::models
