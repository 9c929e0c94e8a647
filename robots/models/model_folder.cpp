#include "robots/models/model_folder.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/pose.hpp"
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

}  // namespace

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

}  // namespace kinship::models
