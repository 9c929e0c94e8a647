#include "robots/kinematics/gripping_joint.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <string_view>

namespace kinship::kinematics {
namespace {

// Fingers of grippers travel 10 to 85 mm, the shortest linear axes of arms (SCARAs) 100 mm.
constexpr double kLongestFingerStroke_m = 0.1;
// A jaw opens by less than half a turn; wrists turn farther.
constexpr double kWidestJaw_rad = std::numbers::pi;
constexpr double kClosed_rad = 0.05;  // of a jaw, where a limit is
constexpr std::size_t kWholeArm = 6;  // joints that place a hand anywhere
constexpr std::array<std::string_view, 6> kJawNames = {"jaw",  "finger",  "gripper",
                                                       "claw", "knuckle", "thumb"};

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_named_as_jaw(const TreeLink& link) {
  const std::string names = lower_case(link.name + " " + link.joint.name);
  return std::ranges::any_of(
      kJawNames, [&](std::string_view word) { return names.find(word) != std::string::npos; });
}

bool turns_to_one_side(const TreeJoint& joint) {
  if (joint.type != "revolute" || !joint.lower || !joint.upper)
    return false;
  return *joint.upper - *joint.lower < kWidestJaw_rad &&
         std::min(std::abs(*joint.lower), std::abs(*joint.upper)) <= kClosed_rad;
}

bool is_wide_jaw(const TreeJoint& joint) {
  return joint.type == "revolute" && joint.lower && joint.upper &&
         *joint.upper - *joint.lower < kWidestJaw_rad;
}

bool is_followed(const std::vector<TreeLink>& tree, const std::string& joint) {
  return std::ranges::any_of(tree,
                             [&](const TreeLink& link) { return link.joint.mimics == joint; });
}

bool has_twin(const std::vector<TreeLink>& tree, std::size_t link) {
  for (std::size_t i = 1; i < tree.size(); ++i)
    if (i != link && tree[i].parent == tree[link].parent &&
        tree[i].joint.type == tree[link].joint.type)
      return true;
  return false;
}

bool is_leaf(const std::vector<TreeLink>& tree, std::size_t link) {
  return std::ranges::none_of(tree, [&](const TreeLink& other) {
    return other.parent == static_cast<int>(link) && other.joint.type != "fixed";
  });
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

}  // namespace

bool is_gripping_joint(const std::vector<TreeLink>& tree, std::size_t link, std::size_t before) {
  const TreeJoint& joint = tree[link].joint;
  if (is_followed(tree, joint.name) || has_twin(tree, link))
    return true;
  if (joint.type == "prismatic")
    return joint.lower && joint.upper && *joint.upper - *joint.lower < kLongestFingerStroke_m;
  return (is_named_as_jaw(tree[link]) && is_wide_jaw(joint)) ||
         (before >= kWholeArm && turns_to_one_side(joint));
}

std::vector<std::string> describe_mobile_base(const std::vector<TreeLink>& tree) {
  std::vector<std::string> sentences;
  for (const TreeLink& link : tree)
    if (link.joint.type == "planar" || link.joint.type == "floating")
      sentences.push_back("joint '" + link.joint.name + "' (" + link.joint.type + ") carries '" +
                          link.name +
                          "': a mobile base; no chain has such a joint, so choose --base below it "
                          "and say in T_task_base (the placement) where the base stands");
  std::vector<std::string> wheels;
  for (std::size_t i = 1; i < tree.size(); ++i)
    if (tree[i].joint.type == "continuous" && tree[i].joint.mimics.empty() && is_leaf(tree, i) &&
        has_twin(tree, i))
      wheels.push_back(tree[i].joint.name);
  if (!wheels.empty())
    sentences.push_back("joints " + listed(wheels) +
                        " turn without end and carry nothing: wheels of a mobile base, held at 0; "
                        "say in T_task_base (the placement) where the base stands");
  return sentences;
}

}  // namespace kinship::kinematics
