#include "robots/inverse/elimination.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/types/turn.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::inverse {
namespace {

constexpr int kTurns = 6;
constexpr int kThirds = 3;  // of a turn: as many as 1, cos and sin take
constexpr int kPosesTried = 32;
constexpr double kGivenBack_rad = 1e-3;
constexpr double kGivenBackShare = 0.9;
constexpr std::uint64_t kPoseSeed = 0x73697872;

using Invariants = Eigen::Matrix<double, LaneElimination::kInvariants, 1>;

/// As the kernel orders them: invariants of a turn about z, then pairs of x and y.
Invariants invariants_of(const Eigen::Isometry3d& T) {
  const Eigen::Vector3d l = T.linear().col(2), p = T.translation();
  const Eigen::Vector3d moment = p.cross(l);
  const Eigen::Vector3d mirrored = p.dot(p) * l - 2 * p.dot(l) * p;
  Invariants result;
  result << l.z(), p.z(), p.dot(p), p.dot(l), moment.z(), mirrored.z(), l.x(), l.y(), p.x(), p.y(),
      moment.x(), moment.y(), mirrored.x(), mirrored.y();
  return result;
}

Eigen::Isometry3d link(const LaneJoint& joint) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(joint.p[0], joint.p[1], joint.p[2]);
  T.linear() =
      Eigen::AngleAxisd(std::atan2(joint.tilt_sine, joint.tilt_cosine), Eigen::Vector3d::UnitX())
          .toRotationMatrix();
  return T;
}

double third(int i) { return i * kTurn / kThirds; }

/// Share of the value at a third of a turn in the coefficient of 1, cos or sin.
double share(int coefficient, int i) {
  if (coefficient == 0)
    return 1.0 / kThirds;
  return 2.0 / kThirds * (coefficient == 1 ? std::cos(third(i)) : std::sin(third(i)));
}

/// The last axis, seen from the second, with joints 3, 4 and 5 at thirds of a turn.
Eigen::Isometry3d last_axis(const LaneChain& lanes, int third_3, int third_4, int third_5) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return link(lanes.joints[2]) * Eigen::AngleAxisd(third(third_3), z) * link(lanes.joints[3]) *
         Eigen::AngleAxisd(third(third_4), z) * link(lanes.joints[4]) *
         Eigen::AngleAxisd(third(third_5), z) * link(lanes.joints[5]);
}

/// Adds a multiple of invariants to all terms of one sine or cosine of joints 3 and 5.
/// \param half  shares of sin^2, sin cos and cos^2 of half of joint 4.
void add_terms(const Invariants& values, int of_3, const double (&half)[3], int of_5, double scale,
               LaneElimination& arm) {
  for (int r = 0; r < LaneElimination::kInvariants; ++r)
    for (int b = 0; b < 3; ++b)
      arm.terms[r][9 * of_3 + 3 * b + of_5] += scale * half[b] * values[r];
}

LaneElimination terms_of(const LaneChain& lanes) {
  constexpr double kHalves[3][3] = {{1, 0, 1}, {-1, 0, 1}, {0, 2, 0}};  // of 1, cos and sin
  LaneElimination arm{};
  for (int i = 0; i < kThirds * kThirds * kThirds; ++i) {
    const int at_3 = i / 9, at_4 = i / 3 % 3, at_5 = i % 3;
    const Invariants values = invariants_of(last_axis(lanes, at_3, at_4, at_5));
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c)
          add_terms(values, a, kHalves[b], c, share(a, at_3) * share(b, at_4) * share(c, at_5),
                    arm);
  }
  return arm;
}

LaneHarmonics made_harmonics() {
  using Tables = LaneHarmonics;
  Tables tables{};
  for (int i = 0; i < Tables::kSamples; ++i) {
    const double angle = i * kTurn / Tables::kSamples;
    tables.cosine[i] = std::cos(angle);
    tables.sine[i] = std::sin(angle);
    for (int k = 0; k <= Tables::kDegree; ++k) {
      const double scale = (k == 0 ? 1.0 : 2.0) / Tables::kSamples;
      tables.to_coefficients[i][k] = scale * std::cos(k * angle);
      if (k > 0)
        tables.to_coefficients[i][Tables::kDegree + k] = scale * std::sin(k * angle);
    }
  }
  for (int i = 0; i < Tables::kPoints; ++i)
    for (int k = 0; k <= Tables::kDegree; ++k) {
      const double angle = k * i * kTurn / Tables::kIntervals;
      tables.at_points[k][i] = std::cos(angle);
      // Where a half turn ends both halves of the circle have to see the same sign.
      if (k > 0)
        tables.at_points[Tables::kDegree + k][i] =
            i == Tables::kIntervals / 2 ? 0 : std::sin(angle);
    }
  return tables;
}

/// Whether one of the branches is that configuration (lane's values).
bool gives_back(const LaneBranches& branches, const double* q) {
  for (int b = 0; b < branches.count; ++b) {
    bool near = true;
    for (int j = 0; j < kTurns; ++j)
      near = near && std::abs(wrapped(branches.q[j][b] - q[j])) < kGivenBack_rad;  // not if NaN
    if (near)
      return true;
  }
  return false;
}

bool is_of_use(const kinematics::Chain& chain, const LaneChain& lanes, const SimdKernels& kernels,
               const LaneElimination& arm) {
  CounterGenerator generator(kPoseSeed);
  int given_back = 0;
  for (int i = 0; i < kPosesTried; ++i) {
    Eigen::VectorXd q(kTurns);
    double raw[kTurns], target[12];
    for (int j = 0; j < kTurns; ++j) {
      q[j] = (2 * generator.uniform() - 1) * std::numbers::pi;
      raw[j] = q[j] + lanes.joints[j].offset;
    }
    write_target(kinematics::T_base_transfer(chain, q), lanes.length_m, target);
    LaneBranches branches;
    kernels.eliminate(lanes, arm, harmonics(), target, branches);
    given_back += gives_back(branches, raw) ? 1 : 0;
  }
  return given_back >= kGivenBackShare * kPosesTried;
}

}  // namespace

const LaneHarmonics& harmonics() {
  static const LaneHarmonics kTables = made_harmonics();
  return kTables;
}

void write_target(const Eigen::Isometry3d& T_base_transfer, double length_m, double (&target)[12]) {
  for (int i = 0; i < 12; ++i)
    target[i] = i < 9 ? T_base_transfer(i / 3, i % 3) : T_base_transfer(i - 9, 3) / length_m;
}

std::optional<LaneElimination> elimination_of(const kinematics::Chain& chain,
                                              const LaneChain& lanes, const SimdKernels& kernels) {
  const bool turns = std::none_of(lanes.joints, lanes.joints + lanes.dof,
                                  [](const LaneJoint& joint) { return joint.slides; });
  if (lanes.dof != kTurns || lanes.rows != kTurns || !turns)
    return std::nullopt;
  const LaneElimination arm = terms_of(lanes);
  if (!is_of_use(chain, lanes, kernels, arm))
    return std::nullopt;
  return arm;
}

}  // namespace kinship::inverse
