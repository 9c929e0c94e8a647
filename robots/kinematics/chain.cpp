#include "robots/kinematics/chain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::kinematics {
namespace {

constexpr double kUnitTolerance = 1e-9;
constexpr double kDigestGrid = 1e-9;

std::optional<std::string> validate(std::string_view what, const Eigen::Isometry3d& T) {
  const std::string name(what);
  if (!T.matrix().allFinite())
    return name + ": pose is not finite";
  const double largest_m = T.translation().cwiseAbs().maxCoeff();
  if (largest_m > kMaxPlacement_m)
    return name + ": coordinate " + number_text(largest_m) + " m exceeds " +
           number_text(kMaxPlacement_m) + " m";
  const Eigen::Matrix3d R = T.linear();
  if (!(R.transpose() * R).isIdentity(kUnitTolerance) || R.determinant() < 0)
    return name + ": orientation is not a rotation";
  return std::nullopt;
}

std::optional<std::string> validate(const Joint& joint) {
  const std::string name = "joint '" + joint.name + "'";
  if (auto fault = validate(name, joint.T_previous_joint))
    return fault;
  if (!joint.axis.allFinite() || std::abs(joint.axis.norm() - 1) > kUnitTolerance)
    return name + ": axis has length " + number_text(joint.axis.norm()) + ", must be 1";
  if (joint.type == JointType::Continuous)
    return std::nullopt;
  for (const double limit : {joint.lower, joint.upper})
    if (!(std::abs(limit) <= kMaxPlacement_m))
      return name + ": limit " + number_text(limit) + " exceeds " + number_text(kMaxPlacement_m);
  if (!(joint.lower < joint.upper))
    return name + ": lower limit " + number_text(joint.lower) + " is not below upper limit " +
           number_text(joint.upper);
  return std::nullopt;
}

/// The least and the largest value of a mimic joint.
std::pair<double, double> limits_of(const MimicJoint& mimic, const Joint& source) {
  const bool turns = source.type == JointType::Continuous;
  const double lower = turns ? -std::numbers::pi : source.lower;
  const double upper = turns ? std::numbers::pi : source.upper;
  return std::minmax(
      {mimic.multiplier * lower + mimic.offset, mimic.multiplier * upper + mimic.offset});
}

/// \param index  of the moving joint; the chain's joints are without fault.
std::optional<std::string> validate(const MimicJoint& mimic, const std::vector<Joint>& joints,
                                    int index) {
  const std::string name = "joint '" + mimic.joint.name + "'";
  if (mimic.source < 0 || mimic.source >= static_cast<int>(joints.size()))
    return name + ": mimics joint " + std::to_string(mimic.source) + " of " +
           std::to_string(joints.size());
  if (mimic.before < -1 || mimic.before >= index)
    return name + ": joint index " + std::to_string(mimic.before) + " is not below its own, " +
           std::to_string(index);
  const Joint& source = joints[static_cast<std::size_t>(mimic.source)];
  const std::string follows = name + " mimics joint '" + source.name + "'";
  const auto [lower, upper] = limits_of(mimic, source);
  for (const double limit : {lower, upper})
    if (!(std::abs(limit) <= kMaxPlacement_m))
      return follows + " at " + number_text(limit) + ", more than " + number_text(kMaxPlacement_m);
  // A configuration is the same after a full turn, so its followers have to be.
  if (source.type == JointType::Continuous && (mimic.joint.type == JointType::Prismatic ||
                                               mimic.multiplier != std::round(mimic.multiplier)))
    return follows + ", which is continuous, times " + number_text(mimic.multiplier) +
           ": where it stands would depend on full turns, which is not supported; hold it";
  Joint joint = mimic.joint;
  joint.type = JointType::Continuous;  // without limits of its own
  return validate(joint);
}

std::optional<std::string> validate(const std::vector<ChainLink>& links, int moving_joints) {
  for (int i = 0; i < static_cast<int>(links.size()); ++i) {
    const ChainLink& link = links[static_cast<std::size_t>(i)];
    const std::string name = "link '" + link.name + "'";
    if (auto fault = validate(name, link.T_joint_link))
      return fault;
    if (link.joint < -1 || link.joint >= moving_joints)
      return name + ": joint index " + std::to_string(link.joint) + " is not below " +
             std::to_string(moving_joints);
    if (link.parent < -1 || link.parent >= i)
      return name + ": parent index " + std::to_string(link.parent) + " is not below its own, " +
             std::to_string(i);
  }
  return std::nullopt;
}

void add(Sha256& sha, double value) { sha.add(std::round(value / kDigestGrid)); }

void add(Sha256& sha, const Eigen::Isometry3d& T) {
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 4; ++column)
      add(sha, T.matrix()(row, column));
}

}  // namespace

std::optional<std::string> validate(const ChainParts& parts) {
  if (parts.joints.empty())
    return "chain: no moving joint";
  if (parts.joints.size() > kMaxDof)
    return "chain: " + std::to_string(parts.joints.size()) + " moving joints exceed " +
           std::to_string(kMaxDof);
  for (const Joint& joint : parts.joints)
    if (auto fault = validate(joint))
      return fault;
  if (auto fault = validate("tip link '" + parts.tip_link + "'", parts.T_last_tip))
    return fault;
  if (auto fault = validate("transfer frame", parts.T_tip_transfer))
    return fault;
  const auto& matters = parts.task_axes.matters;
  if (std::none_of(matters.begin(), matters.end(), [](bool axis) { return axis; }))
    return "task axes: none matters, need at least one";
  int moving_joints = static_cast<int>(parts.joints.size());
  for (const MimicJoint& mimic : parts.mimics)
    if (auto fault = validate(mimic, parts.joints, moving_joints++))
      return fault;
  return validate(parts.links, moving_joints);
}

Chain::Chain(ChainParts parts) : parts_(std::move(parts)) {
  if (const auto fault = validate(parts_))
    throw std::invalid_argument("Chain: " + *fault);
  lower_.resize(dof());
  upper_.resize(dof());
  Eigen::Index i = 0;
  for (Joint& joint : parts_.joints) {
    if (joint.type == JointType::Continuous) {
      joint.lower = -std::numbers::pi;
      joint.upper = std::numbers::pi;
    }
    lower_[i] = joint.lower;
    upper_[i] = joint.upper;
    ++i;
  }
  for (MimicJoint& mimic : parts_.mimics)
    std::tie(mimic.joint.lower, mimic.joint.upper) =
        limits_of(mimic, parts_.joints[static_cast<std::size_t>(mimic.source)]);
}

bool Chain::within_limits(const Eigen::Ref<const Eigen::VectorXd>& q, double tolerance) const {
  if (q.size() != dof())
    throw std::invalid_argument("within_limits: " + std::to_string(q.size()) + " values for " +
                                std::to_string(dof()) + " joints");
  for (Eigen::Index i = 0; i < dof(); ++i) {
    if (parts_.joints[static_cast<std::size_t>(i)].type == JointType::Continuous) {
      if (!std::isfinite(q[i]))
        return false;
    } else if (!(q[i] >= lower_[i] - tolerance && q[i] <= upper_[i] + tolerance)) {
      return false;
    }
  }
  return true;
}

int Chain::moving_joints() const noexcept {
  return static_cast<int>(parts_.joints.size() + parts_.mimics.size());
}

const Joint& Chain::moving_joint(int joint) const noexcept {
  const auto index = static_cast<std::size_t>(joint);
  const std::size_t on_chain = parts_.joints.size();
  return index < on_chain ? parts_.joints[index] : parts_.mimics[index - on_chain].joint;
}

int Chain::joint_before(int joint) const noexcept {
  return joint < dof() ? joint - 1 : parts_.mimics[static_cast<std::size_t>(joint - dof())].before;
}

int Chain::joint_before_both(int a, int b) const noexcept {
  while (a != b)
    (a > b ? a : b) = joint_before(std::max(a, b));
  return a;
}

int Chain::last_source(int joint) const noexcept {
  int last = -1;
  for (; joint >= dof(); joint = joint_before(joint))
    last = std::max(last, parts_.mimics[static_cast<std::size_t>(joint - dof())].source);
  return std::max(last, joint);
}

int Chain::find_link(std::string_view name) const noexcept {
  const auto& links = parts_.links;
  const auto link = std::find_if(links.begin(), links.end(), [&](const ChainLink& candidate) {
    return candidate.name == name;
  });
  return link == links.end() ? -1 : static_cast<int>(link - links.begin());
}

Digest Chain::digest() const {
  Sha256 sha;
  sha.add(std::string_view("kinship robot 1")).add(static_cast<std::uint64_t>(dof()));
  for (const Joint& joint : parts_.joints) {
    sha.add(static_cast<std::uint64_t>(joint.type));
    add(sha, joint.T_previous_joint);
    for (const double coordinate : joint.axis)
      add(sha, coordinate);
    if (joint.type == JointType::Continuous)
      continue;
    add(sha, joint.lower);
    add(sha, joint.upper);
  }
  add(sha, parts_.T_last_tip);
  add(sha, parts_.T_tip_transfer);
  for (const bool axis : parts_.task_axes.matters)
    sha.add(std::uint64_t{axis});
  return sha.finish();
}

}  // namespace kinship::kinematics
