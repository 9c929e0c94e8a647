// EAIK's side of inverse_bench: reference_eaik ROBOT POSES, prints configurations per second of CPU
// time, the poses that it missed, and the joint that was locked (from 1; 0: none). Built where
// KINSHIP_EAIK_ROOT tells where EAIK is; README.md says what it expects there.
//
// EAIK decomposes arms of up to six joints. One of seven has a joint locked at a value drawn anew
// for each pose, for which EAIK takes a new object: of the joints whose lock it can decompose, the
// one that gives most. EAIK knows neither limits nor distances: its configurations are chosen as
// ours are, outside the time taken. An arm that it cannot decompose: 0, all poses, 0. Exit code 1
// if it decomposes an arm and reaches no pose: then the two are not about the same arm.

#include <EAIK.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/chain.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/reachable_poses.hpp"

namespace kinship::bench {
namespace {

constexpr double kPrecision = 1e-6;  // as ours
constexpr double kMinDistance = 0.2;
constexpr std::size_t kMaxSolutions = 8;
constexpr Eigen::Index kMaxDecomposed = 6;  // joints
constexpr int kRounds = 5;
constexpr int kNoLock = -1;

/// A chain as EAIK wants it, in the base link with every joint at 0.
class EaikArm {
 public:
  explicit EaikArm(const kinematics::Chain& arm)
      : axes_(3, arm.dof()),
        ways_(3, arm.dof() + 1),
        T_base_transfer_(
            kinematics::T_base_transfer(arm, Eigen::VectorXd(Eigen::VectorXd::Zero(arm.dof())))) {
    Eigen::Isometry3d T_base_joint = Eigen::Isometry3d::Identity();
    Eigen::Vector3d p_base_last = Eigen::Vector3d::Zero();
    Eigen::Index column = 0;
    for (const kinematics::Joint& joint : arm.joints()) {
      T_base_joint = T_base_joint * joint.T_previous_joint;
      axes_.col(column) = T_base_joint.linear() * joint.axis;
      ways_.col(column++) = T_base_joint.translation() - p_base_last;
      p_base_last = T_base_joint.translation();
    }
    ways_.col(column) = T_base_transfer_.translation() - p_base_last;
  }

  EAIK::Robot robot() const { return {axes_, ways_, T_base_transfer_.linear()}; }
  EAIK::Robot robot(int lock, double value) const {
    return {axes_, ways_, T_base_transfer_.linear(), {{lock, value}}};
  }

 private:
  Eigen::MatrixXd axes_;  // 3 x dof
  Eigen::MatrixXd ways_;  // 3 x (dof + 1), from a point of one axis to a point of the next, m
  Eigen::Isometry3d T_base_transfer_;
};

/// What EAIK finds with one joint locked, or with none.
struct Result {
  bool decomposed = false;
  double configurations_per_s = 0;
  std::size_t missed = 0;
  int lock = kNoLock;
};

class Measurement {
 public:
  Measurement(const kinematics::Chain& arm, int poses)
      : arm_(arm), space_(arm), eaik_(arm), wanted_(reachable_poses(arm, poses)) {}

  Result best() const {
    Result best{false, 0, wanted_.size(), kNoLock};
    if (arm_.dof() <= kMaxDecomposed)
      return eaik_.robot().has_known_decomposition() ? measure(kNoLock) : best;
    for (int lock = 0; lock < arm_.dof(); ++lock) {
      if (!eaik_.robot(lock, space_.value_at(lock, kAnyShare)).has_known_decomposition())
        continue;
      const Result result = measure(lock);
      if (!best.decomposed || result.configurations_per_s > best.configurations_per_s)
        best = result;
    }
    return best;
  }

 private:
  static constexpr double kAnyShare = 0.37;  // of a joint's range: no angle that decomposes better

  Result measure(int lock) const {
    std::vector<IKS::IK_Solution> found;
    const double taken_s = least_s(kRounds, thread_cpu_s, [&] { found = solve_all(lock); });
    std::size_t configurations = 0, missed = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::size_t chosen = choose(found[i], wanted_[i]);
      configurations += chosen;
      missed += chosen == 0 ? 1 : 0;
    }
    return {true, static_cast<double>(configurations) / taken_s, missed, lock};
  }

  std::vector<IKS::IK_Solution> solve_all(int lock) const {
    std::mt19937_64 generator(2);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<IKS::IK_Solution> found;
    found.reserve(wanted_.size());
    if (lock == kNoLock) {
      const EAIK::Robot robot = eaik_.robot();
      for (const Eigen::Isometry3d& T_base_transfer : wanted_)
        found.push_back(robot.calculate_IK(T_base_transfer.matrix()));
      return found;
    }
    for (const Eigen::Isometry3d& T_base_transfer : wanted_)
      found.push_back(solve(lock, space_.value_at(lock, share(generator)), T_base_transfer));
    return found;
  }

  /// Empty also where EAIK gives up: next to values that make axes parallel it throws.
  IKS::IK_Solution solve(int lock, double value, const Eigen::Isometry3d& T_base_transfer) const {
    try {
      return eaik_.robot(lock, value).calculate_IK(T_base_transfer.matrix());
    } catch (const std::runtime_error&) {
      return {};
    }
  }

  /// How many are within the limits, reach the pose and lie apart.
  std::size_t choose(const IKS::IK_Solution& found,
                     const Eigen::Isometry3d& T_base_transfer) const {
    std::vector<Eigen::VectorXd> chosen;
    for (const std::vector<double>& solution : found.Q) {
      Eigen::VectorXd q = Eigen::VectorXd::Map(solution.data(), arm_.dof());
      if (q.allFinite() && space_.normalize(q.data()) &&
          kinematics::T_base_transfer(arm_, q).isApprox(T_base_transfer, kPrecision) &&
          std::all_of(chosen.begin(), chosen.end(), [&](const Eigen::VectorXd& other) {
            return space_.squared_distance(q.data(), other.data()) >= kMinDistance * kMinDistance;
          }))
        chosen.push_back(std::move(q));
    }
    return std::min(chosen.size(), kMaxSolutions);
  }

  const kinematics::Chain& arm_;
  inverse::JointSpace space_;
  EaikArm eaik_;
  std::vector<Eigen::Isometry3d> wanted_;
};

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  using namespace kinship;
  if (argc != 3)
    return 2;
  const kinematics::Chain arm = test::model_chain(argv[1]);
  const bench::Result best = bench::Measurement(arm, std::stoi(argv[2])).best();
  if (best.decomposed && best.configurations_per_s == 0) {
    std::cerr << argv[1] << ": EAIK decomposes it, but none of its configurations is right\n";
    return 1;
  }
  std::cout << best.configurations_per_s << ' ' << best.missed << ' ' << best.lock + 1 << '\n';
  return 0;
}
