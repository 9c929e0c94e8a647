#include "robots/models/robot_arguments.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/pose.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/geometry/srdf.hpp"
#include "robots/models/mesh_files.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

constexpr std::size_t kMaxChainFileBytes = 262'144;

/// The fields of one chain.toml. Every method throws Failure that names file and field.
class ChainFile {
 public:
  ChainFile(const std::filesystem::path& file, std::string_view text) : name_(file.string()) {
    try {
      table_ = toml::parse(text);
    } catch (const toml::parse_error& error) {
      throw Failure(ErrorCode::InvalidInput, name_ + ": line " +
                                                 std::to_string(error.source().begin.line) + ": " +
                                                 std::string(error.description()));
    }
    for (const auto& [key, value] : table_)
      if (std::find(kFields.begin(), kFields.end(), key.str()) == kFields.end())
        refuse(key.str(), "is not a field of this file");
  }

  std::string text(std::string_view field) const {
    const auto value = table_[field].value<std::string>();
    if (!value)
      refuse(field, "must be there, as text");
    return *value;
  }

  Eigen::Isometry3d transfer() const {
    const toml::array* numbers = array("transfer");
    if (numbers == nullptr)
      refuse("transfer", "must be there: [x, y, z, qx, qy, qz, qw]");
    PoseArray pose{};
    if (numbers->size() != pose.size())
      refuse("transfer", "has " + std::to_string(numbers->size()) + " numbers, must have 7");
    for (std::size_t i = 0; i < pose.size(); ++i)
      pose[i] = number("transfer", (*numbers)[i]);
    const auto T = from_pose_array(pose);
    if (!T)
      refuse("transfer", T.error().message);
    return *T;
  }

  TaskAxes axes() const {
    const toml::array* names = array("axes");
    if (names == nullptr)
      return {};
    std::vector<std::string> words;
    for (const toml::node& node : *names)
      words.push_back(node.value<std::string>().value_or(""));
    const auto axes = parse_task_axes({words.begin(), words.end()});
    if (!axes)
      refuse("axes", axes.error().message);
    return *axes;
  }

  std::map<std::string, double> hold() const {
    std::map<std::string, double> held;
    const toml::node* node = table_.get("hold");
    if (node == nullptr)
      return held;
    if (!node->is_table())
      refuse("hold", "must be a table of joints and values");
    for (const auto& [joint, value] : *node->as_table())
      held.emplace(joint.str(), number("hold." + std::string(joint.str()), value));
    if (held.size() > kMaxHeldJoints)
      refuse("hold",
             std::to_string(held.size()) + " joints exceed " + std::to_string(kMaxHeldJoints));
    return held;
  }

  std::vector<std::pair<std::string, std::string>> never_colliding() const {
    std::vector<std::pair<std::string, std::string>> pairs;
    const toml::array* rows = array("never_colliding");
    if (rows == nullptr)
      return pairs;
    if (rows->size() > kMaxCollisionPairs)
      refuse("never_colliding",
             std::to_string(rows->size()) + " pairs exceed " + std::to_string(kMaxCollisionPairs));
    for (const toml::node& row : *rows) {
      const toml::array* pair = row.as_array();
      if (pair == nullptr || pair->size() != 2 || !(*pair)[0].is_string() ||
          !(*pair)[1].is_string())
        refuse("never_colliding",
               "pair " + std::to_string(pairs.size() + 1) + " is not [link, link]");
      pairs.emplace_back((*pair)[0].ref<std::string>(), (*pair)[1].ref<std::string>());
    }
    return pairs;
  }

 private:
  static constexpr std::array<std::string_view, 7> kFields = {
      "label", "base", "tip", "transfer", "axes", "hold", "never_colliding"};

  [[noreturn]] void refuse(std::string_view field, const std::string& problem) const {
    throw Failure(ErrorCode::InvalidInput, name_ + ": " + std::string(field) + ": " + problem);
  }

  double number(std::string_view field, const toml::node& node) const {
    if (!node.is_number())
      refuse(field, "holds something that is not a number");
    return node.value<double>().value_or(0);
  }

  /// Null if the field is missing.
  const toml::array* array(std::string_view field) const {
    const toml::node* node = table_.get(field);
    if (node != nullptr && !node->is_array())
      refuse(field, "must be a list");
    return node == nullptr ? nullptr : node->as_array();
  }

  std::string name_;
  toml::table table_;
};

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

/// \throws Failure with the fault.
RobotDescription read_urdf_file(const RobotArguments& arguments) {
  RobotDescription description;
  description.urdf = read_expanded(arguments.source, urdf_input(arguments));
  std::filesystem::path name = arguments.source.filename();
  if (name.extension() == ".xacro")
    name.replace_extension();
  description.label = name.stem().string();
  return description;
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

/// \throws Failure with the fault.
DescribedRobot put_together(const RobotArguments& arguments) {
  std::error_code unreadable;  // is for read_urdf_file to tell
  const bool is_folder = std::filesystem::is_directory(arguments.source, unreadable);
  DescribedRobot robot{is_folder ? read_model_folder(arguments.source).value_or_throw()
                                 : read_urdf_file(arguments)};
  RobotDescription& description = robot.description;
  if (!is_folder && (arguments.base_link.empty() || arguments.tip_link.empty()))
    throw Failure(
        ErrorCode::InvalidInput,
        "'" + arguments.source.string() +
            "' is a URDF file: needs --base LINK and --tip LINK (or give a model folder); "
            "'kinship robots links " +
            arguments.source.string() + "' shows its links and which could be these");
  if (!arguments.base_link.empty())
    description.base_link = arguments.base_link;
  if (!arguments.tip_link.empty())
    description.tip_link = arguments.tip_link;
  if (!arguments.label.empty())
    description.label = arguments.label;
  else if (const auto error = check_label(description.label))
    throw Failure(error->code, "the robot's name is that of its file, and " + error->message +
                                   "; give another one with --label");
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

XacroInput urdf_input(const RobotArguments& arguments) {
  return {.arguments = arguments.xacro, .max_bytes = kMaxUrdfBytes, .ending = ".urdf"};
}

Result<RobotDescription> read_model_folder(const std::filesystem::path& folder) {
  try {
    const std::filesystem::path file = folder / kChainFile;
    const ChainFile chain(file, read_text(file, kMaxChainFileBytes));
    RobotDescription description;
    description.label = chain.text("label");
    if (const auto error = check_label(description.label))
      return Error{error->code, file.string() + ": " + error->message};
    description.base_link = chain.text("base");
    description.tip_link = chain.text("tip");
    description.T_tip_transfer = chain.transfer();
    description.task_axes = chain.axes();
    description.held_joints = chain.hold();
    description.never_colliding = chain.never_colliding();
    description.urdf = read_text(folder / kUrdfFile, kMaxUrdfBytes);
    return description;
  } catch (const Failure& failure) {
    return failure.error();
  }
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
  std::error_code unreadable;
  return !arguments.transfer.empty() || std::filesystem::is_directory(arguments.source, unreadable);
}

Result<DescribedRobot> describe_robot(const RobotArguments& arguments) {
  try {
    return put_together(arguments);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

Result<kinematics::RobotModel> read_model(DescribedRobot robot) {
  return kinematics::read_model(std::move(robot.description), std::move(robot.urdf));
}

}  // namespace kinship::models
