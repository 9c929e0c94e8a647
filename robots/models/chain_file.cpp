#include "robots/models/chain_file.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <sstream>
#include <system_error>

#include "proto/files/installed_place.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/nearest_name.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

constexpr std::size_t kMaxChainFileBytes = 262'144;

const std::vector<std::string>& known_fields() {
  static const std::vector<std::string> fields = {"label",
                                                  "base",
                                                  "tip",
                                                  "transfer",
                                                  "axes",
                                                  "hold",
                                                  "never_colliding",
                                                  "urdf",
                                                  "srdf",
                                                  "packages",
                                                  "mesh_folders",
                                                  "xacro",
                                                  "collision_from_visual",
                                                  "without_collision",
                                                  "limit_slack"};
  return fields;
}

/// The fields of one file. Every method throws Failure that names file and field.
class Fields {
 public:
  Fields(const std::filesystem::path& file, std::string_view text)
      : name_(file.string()), folder_(file.parent_path()) {
    try {
      table_ = toml::parse(text);
    } catch (const toml::parse_error& error) {
      throw Failure(ErrorCode::InvalidInput, name_ + ": line " +
                                                 std::to_string(error.source().begin.line) + ": " +
                                                 std::string(error.description()));
    }
    for (const auto& [key, value] : table_)
      if (const std::string field(key.str());
          std::ranges::find(known_fields(), field) == known_fields().end())
        refuse(field, "is not a field of this file" + suggestion(field, known_fields()));
  }

  [[noreturn]] void refuse(std::string_view field, const std::string& problem) const {
    throw Failure(ErrorCode::InvalidInput, name_ + ": " + std::string(field) + ": " + problem);
  }

  std::string text(std::string_view field) const {
    const auto value = table_[field].value<std::string>();
    if (!value)
      refuse(field, "must be there, as text");
    return *value;
  }

  /// Empty if the field is missing.
  std::filesystem::path file(std::string_view field) const {
    if (table_.get(field) == nullptr)
      return {};
    const std::string name = text(field);
    if (name.empty())
      refuse(field, "is empty");
    return below(name);
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
    if (table_.get("axes") == nullptr)
      return {};
    const std::vector<std::string> words = texts("axes");
    const auto axes = parse_task_axes({words.begin(), words.end()});
    if (!axes)
      refuse("axes", axes.error().message);
    return *axes;
  }

  std::map<std::string, double> hold() const {
    std::map<std::string, double> held;
    const toml::table* values = table("hold", "joints and values");
    if (values == nullptr)
      return held;
    for (const auto& [joint, value] : *values)
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

  std::map<std::string, std::filesystem::path> packages() const {
    std::map<std::string, std::filesystem::path> folders;
    if (const toml::table* values = table("packages", "names and folders"))
      for (const auto& [name, value] : *values)
        folders.emplace(name.str(), folder("packages." + std::string(name.str()), value));
    return folders;
  }

  std::vector<std::filesystem::path> mesh_folders() const {
    std::vector<std::filesystem::path> folders;
    if (const toml::array* values = array("mesh_folders"))
      for (const toml::node& value : *values)
        folders.push_back(folder("mesh_folders", value));
    return folders;
  }

  std::vector<std::string> xacro() const {
    std::vector<std::string> arguments;
    if (const toml::table* values = table("xacro", "names and texts"))
      for (const auto& [name, value] : *values) {
        const auto text = value.value_exact<std::string>();
        if (!text)
          refuse("xacro." + std::string(name.str()), "must be text");
        arguments.push_back(std::string(name.str()) + ":=" + *text);
      }
    return arguments;
  }

  /// Empty if the field is missing.
  std::vector<std::string> texts(std::string_view field) const {
    std::vector<std::string> words;
    if (const toml::array* values = array(field))
      for (const toml::node& value : *values) {
        const auto word = value.value_exact<std::string>();
        if (!word)
          refuse(field, "holds something that is not text");
        words.push_back(*word);
      }
    return words;
  }

  bool flag(std::string_view field) const {
    const toml::node* node = table_.get(field);
    if (node == nullptr)
      return false;
    if (!node->is_boolean())
      refuse(field, "must be true or false");
    return node->ref<bool>();
  }

  std::optional<double> slack() const {
    const toml::node* node = table_.get("limit_slack");
    if (node == nullptr)
      return std::nullopt;
    const double slack = number("limit_slack", *node);
    if (!(slack >= 0 && slack <= kMaxLimitSlack))
      refuse("limit_slack", number_text(slack) + " is not from 0 to " +
                                number_text(kMaxLimitSlack) + ", joint units");
    return slack;
  }

 private:
  std::filesystem::path below(const std::filesystem::path& name) const { return folder_ / name; }

  std::filesystem::path folder(const std::string& field, const toml::node& node) const {
    const auto name = node.value_exact<std::string>();
    if (!name || name->empty())
      refuse(field, "must be a folder, as text");
    const std::filesystem::path found = below(*name);
    std::error_code unreadable;
    if (!std::filesystem::is_directory(found, unreadable))
      throw Failure(ErrorCode::NotFound,
                    name_ + ": " + field + ": '" + found.string() + "': no such folder");
    return found;
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

  /// Null if the field is missing.
  const toml::table* table(std::string_view field, const std::string& of) const {
    const toml::node* node = table_.get(field);
    if (node != nullptr && !node->is_table())
      refuse(field, "must be a table of " + of);
    return node == nullptr ? nullptr : node->as_table();
  }

  std::string name_;
  std::filesystem::path folder_;
  toml::table table_;
};

/// Text in the notation of TOML.
std::string quoted(const std::string& text) {
  std::ostringstream stream;
  stream << toml::toml_formatter(toml::value<std::string>(text),
                                 toml::format_flags::none);  // "basic" strings
  return stream.str();
}

template <typename Values, typename ToText>
std::string listed(const Values& values, ToText to_text) {
  std::string text;
  for (const auto& value : values)
    text += (text.empty() ? "" : ", ") + to_text(value);
  return '[' + text + ']';
}

std::string path_text(const std::filesystem::path& path) { return quoted(path.string()); }

std::string axes_text(const TaskAxes& axes) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kTaskAxisNames.size(); ++i)
    if (axes.matters[i])
      names.emplace_back(kTaskAxisNames[i]);
  return listed(names, quoted);
}

/// A field with the comment above it.
std::string field_text(const char* comment, const std::string& name, const std::string& value) {
  return std::string("\n# ") + comment + "\n" + name + " = " + value + "\n";
}

/// Tables come last: what follows a table's name in the file is the table's.
std::string tables_text(const ChainFile& chain) {
  std::string text;
  if (!chain.packages.empty())
    text +=
        "\n# Folders of the packages that meshes are named by, package://NAME/...\n[packages]\n";
  for (const auto& [name, folder] : chain.packages)
    text += quoted(name) + " = " + path_text(folder) + "\n";
  if (!chain.xacro.empty())
    text += "\n# Arguments of the xacro files.\n[xacro]\n";
  for (const std::string& argument : chain.xacro) {
    const std::size_t sign = argument.find(":=");
    text += quoted(argument.substr(0, sign)) + " = " + quoted(argument.substr(sign + 2)) + "\n";
  }
  if (!chain.held.empty())
    text += "\n# Where joints off the chain stand, rad or m.\n[hold]\n";
  for (const auto& [joint, value] : chain.held)
    text += quoted(joint) + " = " + number_text(value) + "\n";
  return text;
}

}  // namespace

std::filesystem::path place_of_robot(const std::filesystem::path& source) {
  std::error_code unreadable;  // is for the reader to tell
  if (source.empty() || source.has_parent_path() || std::filesystem::exists(source, unreadable))
    return source;
  const std::filesystem::path brought =
      files::installed_place("robots", KINSHIP_ROBOTS_DIR) / source;
  return is_model_folder(brought) ? brought : source;
}

bool is_model_folder(const std::filesystem::path& source) {
  std::error_code unreadable;  // is for the reader to tell
  return std::filesystem::is_directory(source, unreadable);
}

Result<ChainFile> read_chain_file(const std::filesystem::path& folder) {
  try {
    const std::filesystem::path file = folder / kChainFile;
    const Fields fields(file, read_text(file, kMaxChainFileBytes));
    ChainFile chain;
    chain.label = fields.text("label");
    if (const auto error = check_label(chain.label))
      return Error{error->code, file.string() + ": " + error->message};
    chain.base_link = fields.text("base");
    chain.tip_link = fields.text("tip");
    chain.T_tip_transfer = fields.transfer();
    chain.task_axes = fields.axes();
    chain.held = fields.hold();
    chain.never_colliding = fields.never_colliding();
    chain.urdf = fields.file("urdf");
    if (chain.urdf.empty())
      chain.urdf = folder / kUrdfFile;
    chain.srdf = fields.file("srdf");
    chain.packages = fields.packages();
    chain.mesh_folders = fields.mesh_folders();
    chain.xacro = fields.xacro();
    chain.collision_from_visual = fields.flag("collision_from_visual");
    chain.without_collision = fields.texts("without_collision");
    chain.limit_slack = fields.slack();
    return chain;
  } catch (const Failure& failure) {
    return failure.error();
  }
}

std::string chain_file_text(const ChainFile& chain) {
  const PoseArray transfer = to_pose_array(chain.T_tip_transfer);
  std::string text =
      "# What Kinship has to know of this robot beside its URDF: give the folder of "
      "this file to any command.\n"
      "# Files and folders are relative to it.\n"
      "label = " +
      quoted(chain.label) + "\n";
  if (chain.urdf != kUrdfFile)
    text += "urdf = " + path_text(chain.urdf) + "\n";
  text += field_text("The first and last link of the chain.", "base", quoted(chain.base_link));
  text += "tip = " + quoted(chain.tip_link) + "\n";
  text += field_text(
      "The transfer frame (TCP) in the tip link: x y z (m), qx qy qz qw; z out of "
      "the palm, y closes the fingers.",
      "transfer", listed(transfer, [](double value) { return number_text(value); }));
  if (!chain.task_axes.all())
    text += field_text("The coordinates of the transfer frame that matter.", "axes",
                       axes_text(chain.task_axes));
  if (!chain.srdf.empty())
    text += field_text("Pairs of links that are never checked against each other.", "srdf",
                       path_text(chain.srdf));
  if (!chain.never_colliding.empty())
    text += field_text("Pairs of links that are never checked against each other.",
                       "never_colliding", listed(chain.never_colliding, [](const auto& pair) {
                         return '[' + quoted(pair.first) + ", " + quoted(pair.second) + ']';
                       }));
  if (!chain.mesh_folders.empty())
    text += field_text("Folders in which meshes are looked for that are not where the URDF says.",
                       "mesh_folders", listed(chain.mesh_folders, path_text));
  if (chain.collision_from_visual)
    text += field_text("What is drawn of links without solids is taken for solid.",
                       "collision_from_visual", "true");
  if (!chain.without_collision.empty())
    text += field_text("Links that are drawn and need no solid.", "without_collision",
                       listed(chain.without_collision, quoted));
  if (chain.limit_slack)
    text +=
        field_text("A start or goal beyond a joint limit by less is moved onto it, joint units.",
                   "limit_slack", number_text(*chain.limit_slack));
  return text + tables_text(chain);
}

}  // namespace kinship::models
