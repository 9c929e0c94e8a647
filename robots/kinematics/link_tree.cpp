#include "robots/kinematics/link_tree.hpp"

#include <urdf_model/model.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

#include "robots/kinematics/urdf_model.hpp"

namespace kinship::kinematics {
namespace {

constexpr std::size_t kArmJoints = 3;   // of a branch that is more than a finger
constexpr std::size_t kHandBeyond = 5;  // joints of an arm, and more than those of a torso
constexpr std::array<std::string_view, 4> kPlaces = {"world", "map", "odom", "base_footprint"};
constexpr std::array<std::string_view, 5> kToolNames = {"tool0", "tcp", "tool", "ee_link",
                                                        "flange"};
constexpr std::array<std::string_view, 3> kSensorNames = {"camera", "optical", "aruco"};

std::string type_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return "revolute";
    case urdf::Joint::CONTINUOUS:
      return "continuous";
    case urdf::Joint::PRISMATIC:
      return "prismatic";
    case urdf::Joint::FLOATING:
      return "floating";
    case urdf::Joint::PLANAR:
      return "planar";
    default:
      return "fixed";
  }
}

std::string kind_of(const urdf::Geometry& geometry) {
  switch (geometry.type) {
    case urdf::Geometry::BOX:
      return "box";
    case urdf::Geometry::CYLINDER:
      return "cylinder";
    case urdf::Geometry::SPHERE:
      return "sphere";
    default:
      return "mesh";
  }
}

TreeJoint read_joint_of(const urdf::ModelInterface& model, const urdf::Joint& source) {
  TreeJoint joint{.name = source.name, .type = type_of(source), .lower = {}, .upper = {}};
  const bool has_limits = joint.type == "revolute" || joint.type == "prismatic";
  if (has_limits && source.limits != nullptr) {
    joint.lower = source.limits->lower;
    joint.upper = source.limits->upper;
  }
  if (source.mimic != nullptr)
    joint.mimics = source.mimic->joint_name;
  if (joint.type != "fixed")
    joint.fault = find_joint_fault(model, source);
  return joint;
}

TreeLink read_link_of(const urdf::ModelInterface& model, const urdf::Link& source, int parent) {
  TreeLink link{.name = source.name, .parent = parent, .joint = {}};
  if (source.parent_joint != nullptr)
    link.joint = read_joint_of(model, *source.parent_joint);
  for (const auto& collision : source.collision_array)
    if (collision != nullptr && collision->geometry != nullptr)
      link.collision.push_back(kind_of(*collision->geometry));
  return link;
}

/// A tree with its children, and how many moving joints lie below each link at most.
class Branches {
 public:
  explicit Branches(const std::vector<TreeLink>& tree)
      : tree_(tree),
        children_(tree.size()),
        below_(tree.size(), 0),
        turns_or_slides_(tree.size(), false) {
    for (std::size_t i = tree.size(); i-- > 1;) {
      const auto parent = static_cast<std::size_t>(tree[i].parent);
      if (tree[i].joint.type != "fixed")
        turns_or_slides_[i] = true;
      if (turns_or_slides_[i])
        turns_or_slides_[parent] = true;
      children_[parent].insert(children_[parent].begin(), i);
      below_[parent] = std::max(below_[parent], joints_of(i));
    }
  }

  /// Moving joints of a branch, that of the link itself among them.
  std::size_t joints_of(std::size_t link) const {
    return below_[link] + (tree_[link].joint.moves() ? 1 : 0);
  }
  const std::vector<std::size_t>& children(std::size_t link) const { return children_[link]; }

  /// Links at which arms end, below `link`.
  void find_ends(std::size_t link, std::vector<std::size_t>& ends, std::size_t before = 0) const {
    std::vector<std::size_t> moving, arms;
    std::size_t branches = 0;  // with whatever moves: a finger may follow another one
    for (const std::size_t child : children_[link]) {
      branches += turns_or_slides_[child] ? 1U : 0U;
      if (joints_of(child) > 0)
        moving.push_back(child);
      if (joints_of(child) >= kArmJoints)
        arms.push_back(child);
    }
    const bool is_hand = before >= kHandBeyond && branches > 1 && below_[link] < before;
    if (moving.empty() || (branches > 1 && arms.empty()) || is_hand)
      ends.push_back(link);
    else
      for (const std::size_t child : branches == 1 ? moving : arms)
        find_ends(child, ends, before + (tree_[child].joint.moves() ? 1 : 0));
  }

  /// The links without a moving joint between them and `link`, in the tree's order.
  std::vector<std::size_t> fixed_to(std::size_t link) const {
    while (tree_[link].parent >= 0 && !tree_[link].joint.moves())
      link = static_cast<std::size_t>(tree_[link].parent);
    std::vector<std::size_t> fixed = {link};
    for (std::size_t i = 0; i < fixed.size(); ++i)
      for (const std::size_t child : children_[fixed[i]])
        if (tree_[child].joint.type == "fixed")
          fixed.push_back(child);
    return fixed;
  }

 private:
  const std::vector<TreeLink>& tree_;
  std::vector<std::vector<std::size_t>> children_;
  std::vector<std::size_t> below_;
  std::vector<bool> turns_or_slides_;  // the link, or one below it
};

/// Where an arm ends without the joints of a gripper; `end` itself if there are none, or too few
/// others.
std::size_t before_gripper(const std::vector<TreeLink>& tree, std::size_t end) {
  std::vector<std::size_t> moved;  // by joints of their own, from the tip on
  for (int at = static_cast<int>(end); at >= 0; at = tree[static_cast<std::size_t>(at)].parent)
    if (tree[static_cast<std::size_t>(at)].joint.moves())
      moved.push_back(static_cast<std::size_t>(at));
  std::size_t gripping = 0;
  while (moved.size() - gripping > kArmJoints &&
         is_gripping_joint(tree, moved[gripping], moved.size() - gripping - 1))
    ++gripping;
  return gripping == 0 ? end : static_cast<std::size_t>(tree[moved[gripping - 1]].parent);
}

std::size_t rank_of_tool(const std::string& name) {
  if (std::ranges::any_of(kSensorNames, [&](std::string_view sensor) {
        return name.find(sensor) != std::string::npos;
      }))
    return kToolNames.size() + 1;
  std::size_t rank = 0;
  while (rank < kToolNames.size() && !name.ends_with(kToolNames[rank]))
    ++rank;
  return rank;
}

/// The links fixed to an arm's last joint, outermost first, but links with a tool's name before,
/// and links with a sensor's behind.
std::vector<std::string> tips_at(const std::vector<TreeLink>& tree, const Branches& branches,
                                 std::size_t end) {
  std::vector<std::size_t> fixed = branches.fixed_to(end);
  std::reverse(fixed.begin(), fixed.end());
  std::stable_sort(fixed.begin(), fixed.end(), [&](std::size_t a, std::size_t b) {
    return rank_of_tool(tree[a].name) < rank_of_tool(tree[b].name);
  });
  std::vector<std::string> names;
  for (const std::size_t link : fixed)
    names.push_back(tree[link].name);
  return names;
}

/// The links between the root and an arm's first moving joint, and how many joints move from there.
ChainEnds ends_of(const std::vector<TreeLink>& tree, const Branches& branches, std::size_t end) {
  ChainEnds ends;
  ends.tips = tips_at(tree, branches, end);
  std::vector<std::size_t> way;
  for (int link = static_cast<int>(end); link >= 0;
       link = tree[static_cast<std::size_t>(link)].parent)
    way.insert(way.begin(), static_cast<std::size_t>(link));
  for (const std::size_t link : way) {
    ends.joints += tree[link].joint.moves() ? 1U : 0U;
    if (ends.joints == 0)
      ends.bases.push_back(tree[link].name);
  }
  const auto is_place = [](const std::string& name) {
    return std::ranges::find(kPlaces, name) != kPlaces.end();
  };
  std::stable_partition(ends.bases.begin(), ends.bases.end(), std::not_fn(is_place));
  return ends;
}

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

Result<std::vector<TreeLink>> read_link_tree(const std::string& urdf) {
  const Result<UrdfModel> model = parse_urdf(urdf);
  if (!model)
    return model.error();
  std::vector<urdf::LinkConstSharedPtr> found = {model->tree->getRoot()};
  std::vector<TreeLink> tree = {read_link_of(*model->tree, *found[0], -1)};
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const auto& joint : found[i]->child_joints) {
      found.push_back(model->tree->getLink(joint->child_link_name));
      tree.push_back(read_link_of(*model->tree, *found.back(), static_cast<int>(i)));
    }
  return tree;
}

std::vector<ChainEnds> suggest_ends(const std::vector<TreeLink>& tree) {
  const Branches branches(tree);
  if (tree.empty() || branches.joints_of(0) == 0)
    return {};
  std::vector<std::size_t> links;
  branches.find_ends(0, links);
  std::vector<ChainEnds> all, with_gripper;
  for (const std::size_t link : links) {
    const std::size_t end = before_gripper(tree, link);
    all.push_back(ends_of(tree, branches, end));
    if (end != link)
      with_gripper.push_back(ends_of(tree, branches, link));
  }
  std::erase_if(all, [](const ChainEnds& ends) { return ends.joints == 0; });
  std::ranges::stable_sort(all, std::greater<>(), &ChainEnds::joints);
  all.insert(all.end(), with_gripper.begin(), with_gripper.end());
  return all;
}

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
