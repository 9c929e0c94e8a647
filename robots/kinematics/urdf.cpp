#include "robots/kinematics/urdf.hpp"

#include <urdf_model/model.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/nearest_name.hpp"
#include "proto/types/number_text.hpp"
#include "robots/kinematics/joint_motion.hpp"

namespace kinship::kinematics {
namespace {

constexpr double kShortestAxis = 1e-6;

Failure refused(const std::string& message) { return {ErrorCode::InvalidInput, message}; }

std::string words(const urdf::Joint& joint) { return "joint '" + joint.name + "'"; }

bool moves(const urdf::Joint& joint) { return joint.type != urdf::Joint::FIXED; }

/// A joint with one value: one that a chain consists of, and that can be held.
bool has_one_value(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

Eigen::Isometry3d T_parent_joint(const urdf::Joint& joint) {
  const urdf::Pose& origin = joint.parent_to_joint_origin_transform;
  const urdf::Rotation& r = origin.rotation;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  T.translation() << origin.position.x, origin.position.y, origin.position.z;
  return T;
}

struct Limits {
  double lower = 0, upper = 0;
};

/// The stricter of the hard and the soft limits; soft limits of 0 and 0 are absent ones.
Limits stricter_limits(const urdf::Joint& joint) {
  if (joint.limits == nullptr)
    throw refused(words(joint) + ": no limits");
  const auto check = [&](const std::string& which, double lower, double upper) {
    if (!(lower <= upper))
      throw refused(words(joint) + ": lower" + which + " limit " + number_text(lower) +
                    " exceeds upper" + which + " limit " + number_text(upper));
  };
  Limits limits{joint.limits->lower, joint.limits->upper};
  check("", limits.lower, limits.upper);
  if (joint.safety == nullptr)
    return limits;
  const double soft_lower = joint.safety->soft_lower_limit;
  const double soft_upper = joint.safety->soft_upper_limit;
  if (soft_lower == 0 && soft_upper == 0)
    return limits;
  check(" soft", soft_lower, soft_upper);
  limits.lower = std::max(limits.lower, soft_lower);
  limits.upper = std::min(limits.upper, soft_upper);
  check(" (hard and soft)", limits.lower, limits.upper);
  return limits;
}

/// Type, axis and limits; pose still to be filled in.
Joint read_joint(const urdf::Joint& source) {
  Joint joint;
  joint.name = source.name;
  const Eigen::Vector3d axis(source.axis.x, source.axis.y, source.axis.z);
  const double length = axis.norm();
  if (!(length >= kShortestAxis && std::isfinite(length)))
    throw refused(words(source) + ": axis has length " + number_text(length) +
                  ", which gives no direction");
  joint.axis = axis / length;
  if (source.type == urdf::Joint::CONTINUOUS) {
    joint.type = JointType::Continuous;
    return joint;
  }
  joint.type = source.type == urdf::Joint::PRISMATIC ? JointType::Prismatic : JointType::Revolute;
  const Limits limits = stricter_limits(source);
  joint.lower = limits.lower;
  joint.upper = limits.upper;
  return joint;
}

/// With the link that is nearest to a misspelt one, or some of the existing ones.
Failure unknown_link(const std::string& what, const std::string& name,
                     const urdf::ModelInterface& model) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> links;
  for (const auto& [link, value] : model.links_)
    links.push_back(link);
  std::string advice = suggestion(name, links);
  if (advice.empty()) {
    advice = " (it has ";
    for (std::size_t i = 0; i < std::min(kShown, links.size()); ++i)
      advice += (i == 0 ? "'" : ", '") + links[i] + "'";
    advice +=
        links.size() > kShown ? " and " + std::to_string(links.size() - kShown) + " more)" : ")";
  }
  return refused(cut_text(what + name + "': not in the URDF" + advice, kMaxMessageBytes));
}

/// The joints from base link to tip link, fixed ones too.
std::vector<urdf::JointConstSharedPtr> joints_between(const urdf::ModelInterface& model,
                                                      const std::string& base,
                                                      const std::string& tip) {
  if (model.getLink(base) == nullptr)
    throw unknown_link("base link '", base, model);
  urdf::LinkConstSharedPtr link = model.getLink(tip);
  if (link == nullptr)
    throw unknown_link("tip link '", tip, model);
  std::vector<urdf::JointConstSharedPtr> joints;
  while (link->name != base) {
    if (link->parent_joint == nullptr)
      throw refused("base link '" + base + "' is not an ancestor of tip link '" + tip + "'");
    joints.push_back(link->parent_joint);
    link = link->getParent();
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

std::set<std::string> names_of(const std::vector<urdf::JointConstSharedPtr>& joints) {
  std::set<std::string> names;
  for (const auto& joint : joints)
    names.insert(joint->name);
  return names;
}

void check_on_chain(const urdf::Joint& joint) {
  if (!has_one_value(joint))
    throw refused(words(joint) + " on the chain is floating or planar, which is not supported");
  if (joint.mimic != nullptr)
    throw refused(words(joint) + " on the chain mimics joint '" + joint.mimic->joint_name +
                  "', which is not supported");
}

/// Whether a joint mimics one that the URDF does not have.
bool lacks_leader(const urdf::ModelInterface& model, const urdf::Joint& joint) {
  return joint.mimic != nullptr && model.getJoint(joint.mimic->joint_name) == nullptr;
}

std::string no_leader_text(const urdf::Joint& joint) {
  return "mimics joint '" + joint.mimic->joint_name + "', which is not in the URDF";
}

/// The value of a joint off the chain: constant, or by a joint of the chain that it follows.
struct JointValue {
  double value = 0;         ///< where it stands; of one that follows, its offset
  std::string source = {};  ///< the joint that it follows
  double multiplier = 0;
};

/// Where the joints off the chain stand, and which joints they follow.
class HeldJoints {
 public:
  HeldJoints(const urdf::ModelInterface& model, const std::map<std::string, double>& held,
             const std::set<std::string>& on_chain)
      : model_(model), held_(held), on_chain_(on_chain) {
    for (const auto& [name, value] : held) {
      if (const auto error = check_part_name("held joint", name))
        throw Failure(*error);
      const urdf::JointConstSharedPtr joint = model.getJoint(name);
      if (joint == nullptr)
        throw refused("held joint '" + name + "': not in the URDF");
      if (on_chain.contains(name))
        throw refused("held joint '" + name + "': is on the chain");
      if (!has_one_value(*joint))
        throw refused("held joint '" + name + "': is fixed, floating or planar");
      check_value(*joint, value);
    }
  }

  /// Floating and planar joints stand at zero.
  JointValue value_of(const urdf::Joint& joint) const {
    std::vector<std::string> followers;
    return has_one_value(joint) ? value_of(joint, followers) : JointValue{};
  }

  /// Pose in its parent link of the moving frame of a joint that stands.
  static Eigen::Isometry3d T_parent_moving(const urdf::Joint& joint, const JointValue& stands) {
    Eigen::Isometry3d T = T_parent_joint(joint);
    if (has_one_value(joint))
      move(read_joint(joint), stands.value, T);
    return T;
  }

  /// Of all joints off the chain that have one value and do not follow it.
  std::map<std::string, double> values() const {
    std::map<std::string, double> values;
    for (const auto& [name, joint] : model_.joints_)
      if (has_one_value(*joint) && !on_chain_.contains(name))
        if (const JointValue value = value_of(*joint); value.source.empty())
          values.emplace(name, value.value);
    return values;
  }

 private:
  static void check_value(const urdf::Joint& joint, double value) {
    const bool continuous = joint.type == urdf::Joint::CONTINUOUS;
    const Limits limits =
        continuous ? Limits{-kMaxPlacement_m, kMaxPlacement_m} : stricter_limits(joint);
    if (!(value >= limits.lower && value <= limits.upper))
      throw refused("held joint '" + joint.name + "': value " + number_text(value) +
                    " is outside its limits " + number_text(limits.lower) + " to " +
                    number_text(limits.upper));
  }

  /// \param followers  joints that follow this one, from the first that was asked about on.
  JointValue value_of(const urdf::Joint& joint, std::vector<std::string>& followers) const {
    if (const auto held = held_.find(joint.name); held != held_.end())
      return {held->second};
    JointValue value = mimicked_value(joint, followers);
    if (joint.type == urdf::Joint::CONTINUOUS || !value.source.empty())
      return value;
    const Limits limits = stricter_limits(joint);
    value.value = std::clamp(value.value, limits.lower, limits.upper);
    return value;
  }

  /// The value by the joint that one mimics; 0 if that joint does not move, or there is none.
  JointValue mimicked_value(const urdf::Joint& joint, std::vector<std::string>& followers) const {
    if (lacks_leader(model_, joint))
      throw refused(words(joint) + " " + no_leader_text(joint) + "; hold it where it stands");
    const urdf::JointConstSharedPtr leader =
        joint.mimic == nullptr ? nullptr : model_.getJoint(joint.mimic->joint_name);
    if (leader == nullptr || !has_one_value(*leader))
      return {};
    followers.push_back(joint.name);
    if (followers.size() > model_.joints_.size())
      throw refused(loop_text(followers));
    const urdf::JointMimic& mimic = *joint.mimic;
    if (on_chain_.contains(leader->name))
      return {mimic.offset, leader->name, mimic.multiplier};
    JointValue value = value_of(*leader, followers);
    value.value = mimic.multiplier * value.value + mimic.offset;
    value.multiplier *= mimic.multiplier;
    if (!(std::abs(value.value) <= kMaxPlacement_m))
      throw refused(words(joint) + ": mimics joint '" + leader->name + "' at " +
                    number_text(value.value) + ", more than " + number_text(kMaxPlacement_m));
    return value;
  }

  /// \param followers  with the last one among the ones before it.
  static std::string loop_text(const std::vector<std::string>& followers) {
    auto at = std::find(std::next(followers.rbegin()), followers.rend(), followers.back()).base();
    std::string text = "joint '" + followers.back() + "'";
    for (; at != followers.end(); ++at)
      text += ", which mimics '" + *at + "'";
    return cut_text(text + ": a loop of mimic joints", kMaxMessageBytes);
  }

  const urdf::ModelInterface& model_;
  const std::map<std::string, double>& held_;
  const std::set<std::string>& on_chain_;
};

/// Pose of the URDF's root link in the base link, with every joint between them held.
Eigen::Isometry3d T_base_root(const urdf::Link& base, const HeldJoints& held) {
  Eigen::Isometry3d T_root_base = Eigen::Isometry3d::Identity();
  for (const urdf::Link* link = &base; link->parent_joint != nullptr;
       link = link->getParent().get()) {
    const urdf::Joint& joint = *link->parent_joint;
    const JointValue value = held.value_of(joint);
    if (!value.source.empty())
      throw refused(words(joint) + " before the base link follows joint '" + value.source +
                    "' of the chain, which is not supported; hold it");
    T_root_base = HeldJoints::T_parent_moving(joint, value) * T_root_base;
  }
  return T_root_base.inverse();
}

/// Fills joints' poses and links, from the root link on; parents come before their children.
class TreeWalk {
 public:
  TreeWalk(const HeldJoints& held, const std::vector<urdf::JointConstSharedPtr>& on_chain,
           ChainParts& parts)
      : held_(held), parts_(parts) {
    for (const auto& joint : on_chain) {
      if (!moves(*joint))
        continue;
      check_on_chain(*joint);
      index_[joint->name] = static_cast<int>(parts_.joints.size());
      parts_.joints.push_back(read_joint(*joint));
    }
  }

  void walk(const urdf::ModelInterface& model) {
    std::vector<urdf::LinkConstSharedPtr> found = {model.getRoot()};
    parts_.links.push_back(
        {model.getRoot()->name, -1, T_base_root(*model.getLink(parts_.base_link), held_), -1});
    for (std::size_t i = 0; i < found.size(); ++i)
      for (const auto& joint : found[i]->child_joints) {
        parts_.links.push_back(child_link(*joint, static_cast<int>(i)));
        found.push_back(model.getLink(joint->child_link_name));
      }
    for (const ChainLink& link : parts_.links)
      if (link.name == parts_.tip_link)
        parts_.T_last_tip = link.T_joint_link;
  }

 private:
  ChainLink child_link(const urdf::Joint& joint, int parent) {
    const ChainLink& above = parts_.links[static_cast<std::size_t>(parent)];
    ChainLink link{joint.child_link_name, above.joint, Eigen::Isometry3d::Identity(), parent};
    if (const auto on_chain = index_.find(joint.name); on_chain != index_.end()) {
      link.joint = on_chain->second;
      parts_.joints[static_cast<std::size_t>(link.joint)].T_previous_joint =
          above.T_joint_link * T_parent_joint(joint);
    } else if (link.name != parts_.base_link) {
      const JointValue value = held_.value_of(joint);
      if (value.source.empty())
        link.T_joint_link = above.T_joint_link * HeldJoints::T_parent_moving(joint, value);
      else
        link.joint = add_mimic(joint, value, above);
    }
    return link;
  }

  /// \return the index of the moving joint.
  int add_mimic(const urdf::Joint& joint, const JointValue& value, const ChainLink& above) {
    MimicJoint mimic{read_joint(joint), above.joint, index_.at(value.source), value.multiplier,
                     value.value};
    mimic.joint.T_previous_joint = above.T_joint_link * T_parent_joint(joint);
    parts_.mimics.push_back(mimic);
    return static_cast<int>(parts_.joints.size() + parts_.mimics.size()) - 1;
  }

  const HeldJoints& held_;
  ChainParts& parts_;
  std::map<std::string, int> index_;  // of the chain's moving joints, by name
};

void check_description(const RobotDescription& description) {
  if (const auto error = check_label(description.label))
    throw Failure(*error);
  for (const auto& [what, name] : {std::pair("base link", &description.base_link),
                                   std::pair("tip link", &description.tip_link)}) {
    if (name->empty())
      throw refused(std::string(what) + ": name is empty");
    if (const auto error = check_part_name(what, *name))
      throw Failure(*error);
  }
  if (description.held_joints.size() > kMaxHeldJoints)
    throw refused("held joints: " + std::to_string(description.held_joints.size()) + " exceed " +
                  std::to_string(kMaxHeldJoints));
}

/// \param urdf  parsed here unless it was before.
Chain chain_of(const RobotDescription& description, UrdfModel& urdf) {
  check_description(description);
  if (!urdf.tree)
    urdf = parse_urdf(description.urdf).value_or_throw();
  ChainParts parts;
  parts.base_link = description.base_link;
  parts.tip_link = description.tip_link;
  parts.T_tip_transfer = description.T_tip_transfer;
  parts.task_axes = description.task_axes;
  const auto joints = joints_between(*urdf.tree, description.base_link, description.tip_link);
  const std::set<std::string> on_chain = names_of(joints);
  const HeldJoints held(*urdf.tree, description.held_joints, on_chain);
  TreeWalk(held, joints, parts).walk(*urdf.tree);
  if (const auto fault = validate(parts))
    throw refused(*fault);
  return Chain(std::move(parts));
}

}  // namespace

std::string find_joint_fault(const urdf::ModelInterface& model, const urdf::Joint& joint) {
  if (!has_one_value(joint))
    return "";
  try {
    read_joint(joint);
    return lacks_leader(model, joint) ? no_leader_text(joint) : "";
  } catch (const Failure& failure) {
    return failure.error().message.substr(words(joint).size() + 2);  // after "joint 'j': "
  }
}

std::map<std::string, double> held_values(const RobotModel& robot) {
  const urdf::ModelInterface& tree = *robot.urdf.tree;
  const std::set<std::string> on_chain =
      names_of(joints_between(tree, robot.description.base_link, robot.description.tip_link));
  return HeldJoints(tree, robot.description.held_joints, on_chain).values();
}

Eigen::VectorXd velocity_limits(const RobotModel& robot) {
  Eigen::VectorXd limits = Eigen::VectorXd::Zero(robot.chain.dof());
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    const auto joint =
        robot.urdf.tree->getJoint(robot.chain.joints()[static_cast<std::size_t>(i)].name);
    if (joint->limits && std::isfinite(joint->limits->velocity) && joint->limits->velocity > 0)
      limits(i) = joint->limits->velocity;
  }
  return limits;
}

std::string name_in_urdf(const RobotModel& robot) { return robot.urdf.tree->getName(); }

Result<RobotModel> read_model(RobotDescription description, UrdfModel parsed) {
  try {
    Chain chain = chain_of(description, parsed);
    return RobotModel{std::move(description), std::move(parsed), std::move(chain)};
  } catch (const Failure& failure) {
    return failure.error();
  }
}

Result<Chain> read_chain(const RobotDescription& description) {
  try {
    UrdfModel urdf;
    return chain_of(description, urdf);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::kinematics
