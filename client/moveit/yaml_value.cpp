#include "client/moveit/yaml_value.hpp"

#include <cmath>
#include <fstream>

#include "proto/types/failure.hpp"

namespace kinship::moveit {
namespace {

/// Written by `ros2 topic echo` for a part that it leaves out.
constexpr const char* kTruncated = "...";

}  // namespace

std::vector<YamlValue> YamlValue::read_all(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream)
    throw Failure(ErrorCode::NotFound, "'" + file.string() + "' cannot be read");
  try {
    std::vector<YamlValue> documents;
    for (const YAML::Node& node : YAML::LoadAll(stream))
      if (!node.IsNull())
        documents.push_back({node, file.string(), ""});
    return documents;
  } catch (const YAML::Exception& error) {
    throw Failure(ErrorCode::InvalidInput, "'" + file.string() + "' line " +
                                               std::to_string(error.mark.line + 1) +
                                               " is no YAML: " + error.msg);
  }
}

YamlValue YamlValue::operator[](const std::string& member) const {
  const std::string way = way_.empty() ? member : way_ + "." + member;
  if (!is_map())
    return {YAML::Node(YAML::NodeType::Null), file_, way, line_};
  // Of a constant node: another one would grow the member that is asked for.
  const YAML::Node& map = node_;
  const YAML::Node value = map[member];
  return {value ? value : YAML::Node(YAML::NodeType::Null), file_, way, line_};
}

YamlValue YamlValue::first_of(std::initializer_list<const char*> members) const {
  for (const char* member : members)
    if (const YamlValue value = (*this)[member]; !value.is_missing())
      return value;
  return (*this)[*members.begin()];
}

std::vector<YamlValue> YamlValue::items() const {
  std::vector<YamlValue> items;
  if (is_missing())
    return items;
  const auto is_truncated = [](const YAML::Node& node) {
    return node.IsScalar() && node.Scalar() == kTruncated;
  };
  if (is_truncated(node_))
    refuse("the list was left out when this was written; ros2 topic echo has --full-length");
  if (!node_.IsSequence())
    refuse("is no list");
  if (node_.size() > 0 && is_truncated(node_[node_.size() - 1]))
    refuse("the list was cut when this was written; ros2 topic echo has --full-length");
  for (std::size_t index = 0; index < node_.size(); ++index)
    items.push_back({node_[index], file_, way_ + "[" + std::to_string(index) + "]"});
  return items;
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::members() const {
  std::vector<std::pair<std::string, YamlValue>> members;
  if (!is_map())
    return members;
  for (const auto& member : node_) {
    if (!member.first.IsScalar())
      refuse("a member's name is no single word");
    const std::string& name = member.first.Scalar();
    members.emplace_back(name,
                         YamlValue(member.first, file_, way_.empty() ? name : way_ + "." + name));
  }
  return members;
}

double YamlValue::number() const {
  double number = 0;
  if (!YAML::convert<double>::decode(node_, number) || !std::isfinite(number))
    refuse(is_missing() ? "a number is missing" : "'" + text() + "' is no finite number");
  return number;
}

bool YamlValue::flag() const {
  const std::string word = text();
  bool flag = false;
  if (!YAML::convert<bool>::decode(node_, flag) && word != "1" && word != "0")
    refuse("'" + word + "' is neither true nor false");
  return flag || word == "1";
}

std::string YamlValue::text() const {
  if (is_missing())
    refuse("is missing");
  if (!node_.IsScalar())
    refuse("is no single value");
  if (node_.Scalar() == kTruncated)
    refuse("was left out when this was written; ros2 topic echo has --full-length");
  return node_.Scalar();
}

void YamlValue::refuse(const std::string& why) const {
  std::string place = "'" + file_ + "'";
  if (line_ > 0)
    place += " line " + std::to_string(line_);
  throw Failure(ErrorCode::InvalidInput, place + (way_.empty() ? "" : ", " + way_) + ": " + why);
}

}  // namespace kinship::moveit
