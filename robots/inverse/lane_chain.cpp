#include "robots/inverse/lane_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "proto/types/limits.hpp"
#include "proto/types/turn.hpp"
#include "robots/inverse/lanes.hpp"
#include "robots/kinematics/joint_motion.hpp"

namespace kinship::inverse {
namespace {

using kinematics::JointType;

static_assert(kLaneJoints == kMaxDof);

constexpr double kParallelAxes = 1e-12;    // sine between axes
constexpr double kRightAngle = 1e-15;      // rounding of a zero
constexpr double kShortestReach_m = 1e-3;  // an arm without lengths still has a unit

void write(const Eigen::Matrix3d& matrix, double (&rows)[9]) {
  for (int i = 0; i < 9; ++i)
    rows[i] = matrix(i / 3, i % 3);
}

void write(const Eigen::Vector3d& vector, double (&values)[3]) {
  for (int i = 0; i < 3; ++i)
    values[i] = vector[i];
}

/// A rotation as turns about z, then x, then z.
struct AngleTurns {
  double first_z, x, second_z;
};

AngleTurns turns_of(const Eigen::Matrix3d& R) {
  AngleTurns turns{0, std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2)), 0};
  if (std::hypot(R(0, 2), R(1, 2)) > kParallelAxes)
    turns.first_z = std::atan2(R(0, 2), -R(1, 2));
  // The rest, not the third row: for nearly parallel axes only the sum of the two turns about z is
  // well known.
  const Eigen::Matrix3d left = (Eigen::AngleAxisd(turns.first_z, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(turns.x, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix()
                                   .transpose() *
                               R;
  turns.second_z = std::atan2(left(1, 0) - left(0, 1), left(0, 0) + left(1, 1));
  return turns;
}

/// A turn about z that belongs to a joint's frame: a turning joint takes it up.
void twist(double angle_rad, LaneJoint& joint) {
  (joint.slides ? joint.twist : joint.offset) += angle_rad;
}

/// \param T  of a joint's frame in the moving frame of the one before, both with z along the axis.
void link(const Eigen::Isometry3d& T, double length_m, LaneJoint& before, LaneJoint& joint) {
  const AngleTurns turns = turns_of(T.linear());
  twist(turns.first_z, before);
  twist(turns.second_z, joint);
  joint.tilt_sine = std::sin(turns.x);
  joint.tilt_cosine = std::cos(turns.x);
  if (std::abs(joint.tilt_cosine) < kRightAngle)
    joint.tilt_cosine = 0;
  const Eigen::AngleAxisd back(-turns.first_z, Eigen::Vector3d::UnitZ());
  write(back * T.translation() / length_m, joint.p);
  for (double& coordinate : joint.p)
    if (std::abs(coordinate) < kRightAngle)
      coordinate = 0;
}

void set_limits(const kinematics::Joint& joint, double length_m, LaneJoint& lane) {
  lane.scale = lane.slides ? 1 / length_m : 1;
  lane.middle = 0.5 * (joint.lower + joint.upper) * lane.scale + lane.offset;
  lane.half = 0.5 * (joint.upper - joint.lower) * lane.scale;
  lane.bounded =
      lane.slides || (joint.type == JointType::Revolute && joint.upper - joint.lower < kTurn);
}

struct KnownSets {
  std::array<InstructionSet, 3> sets;
  std::size_t count = 0;
};

KnownSets known_sets() {
  KnownSets known;
  known.sets[known.count++] = {"sse2", sse2_simd_kernels()};
#ifdef KINSHIP_SIMD_X86
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    known.sets[known.count++] = {"avx2", avx2_simd_kernels()};
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    known.sets[known.count++] = {"avx512", avx512_simd_kernels()};
#endif
  return known;
}

}  // namespace

std::span<const InstructionSet> instruction_sets() {
  static const KnownSets kKnown = known_sets();
  return {kKnown.sets.data(), kKnown.count};
}

double reach_m(const kinematics::Chain& chain) {
  double reach = (chain.T_last_tip() * chain.T_tip_transfer()).translation().norm();
  for (std::size_t j = 0; j < chain.joints().size(); ++j) {
    const kinematics::Joint& joint = chain.joints()[j];
    if (j > 0)
      reach += joint.T_previous_joint.translation().norm();
    if (joint.type == JointType::Prismatic)
      reach += std::max(std::abs(joint.lower), std::abs(joint.upper));
  }
  return reach;
}

LaneChain lane_chain(const kinematics::Chain& chain) {
  LaneChain lanes{};
  lanes.dof = static_cast<int>(chain.dof());
  lanes.length_m = std::exp2(std::floor(std::log2(std::max(reach_m(chain), kShortestReach_m))));
  Eigen::Isometry3d T_turned_moving = Eigen::Isometry3d::Identity();  // of the joint before
  for (std::size_t j = 0; j < chain.joints().size(); ++j) {
    const kinematics::Joint& joint = chain.joints()[j];
    Eigen::Isometry3d T_joint_turned = Eigen::Isometry3d::Identity();
    T_joint_turned.linear() = kinematics::rotation_of_z_to(joint.axis);
    const Eigen::Isometry3d T = T_turned_moving * joint.T_previous_joint * T_joint_turned;
    LaneJoint& lane = lanes.joints[j];
    lane.slides = joint.type == JointType::Prismatic;
    if (j == 0) {
      write(T.linear(), lanes.R_first);
      write(T.translation() / lanes.length_m, lanes.p_first);
    } else {
      link(T, lanes.length_m, lanes.joints[j - 1], lane);
    }
    T_turned_moving = T_joint_turned.inverse();
  }
  const Eigen::Isometry3d T = T_turned_moving * chain.T_last_tip() * chain.T_tip_transfer();
  write(T.linear(), lanes.R_last);
  write(T.translation() / lanes.length_m, lanes.p_last);
  for (std::size_t j = 0; j < chain.joints().size(); ++j)
    set_limits(chain.joints()[j], lanes.length_m, lanes.joints[j]);
  std::fill(std::begin(lanes.row_of), std::end(lanes.row_of), 6);
  for (int row = 0; row < 6; ++row)
    if (chain.task_axes().matters[static_cast<std::size_t>(row)])
      lanes.row_of[lanes.rows++] = row;
  return lanes;
}

LaneArm lane_arm(const kinematics::Chain& chain) {
  LaneArm arm{};
  arm.dof = static_cast<int>(chain.dof());
  for (std::size_t j = 0; j < chain.joints().size(); ++j) {
    const kinematics::Joint& joint = chain.joints()[j];
    write(joint.T_previous_joint.linear(), arm.joints[j].R);
    write(joint.T_previous_joint.translation(), arm.joints[j].p);
    write(joint.axis, arm.joints[j].axis);
    arm.joints[j].slides = joint.type == JointType::Prismatic;
  }
  const Eigen::Isometry3d T_last_transfer = chain.T_last_tip() * chain.T_tip_transfer();
  write(T_last_transfer.linear(), arm.R_last);
  write(T_last_transfer.translation(), arm.p_last);
  for (int row = 0; row < 6; ++row)
    arm.matters[row] = chain.task_axes().matters[static_cast<std::size_t>(row)] ? 1 : 0;
  return arm;
}

}  // namespace kinship::inverse
