// KDL's side of inverse_bench: reference_kdl ROBOT POSES, prints solutions per second of CPU time
// and the poses that it missed. Its solver (Levenberg-Marquardt) gives one solution from one start;
// it is started again at random, as users do, until a solution within the limits reaches the pose,
// or kRestarts are used up.

#include <iostream>
#include <kdl/chain.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <random>
#include <string>
#include <vector>

#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/chain.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/reachable_poses.hpp"

namespace kinship::bench {
namespace {

constexpr int kRestarts = 100;
constexpr double kPrecision = 1e-6;  // as ours

KDL::Frame to_kdl(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d p = T.translation();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          KDL::Vector(p[0], p[1], p[2])};
}

/// To the transfer frame.
KDL::Chain to_kdl(const kinematics::Chain& arm) {
  KDL::Chain chain;
  for (const kinematics::Joint& joint : arm.joints()) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(joint.T_previous_joint)));
    chain.addSegment(KDL::Segment(KDL::Joint(
        joint.name, KDL::Vector::Zero(), KDL::Vector(joint.axis[0], joint.axis[1], joint.axis[2]),
        joint.type == kinematics::JointType::Prismatic ? KDL::Joint::TransAxis
                                                       : KDL::Joint::RotAxis)));
  }
  chain.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(arm.T_last_tip() * arm.T_tip_transfer())));
  return chain;
}

/// Solver of one arm with its random starts.
class RestartedSolver {
 public:
  explicit RestartedSolver(const kinematics::Chain& arm)
      : arm_(arm),
        space_(arm),
        chain_(to_kdl(arm)),
        solver_(chain_, kPrecision / 10),
        found_(dof()),
        start_(dof()) {}

  bool reaches(const Eigen::Isometry3d& T_base_transfer) {
    const KDL::Frame wanted = to_kdl(T_base_transfer);
    for (int i = 0; i < kRestarts; ++i) {
      start_.data = test::random_configuration(arm_, generator_);
      if (solver_.CartToJnt(start_, wanted, found_) < 0)
        continue;
      Eigen::VectorXd q = found_.data;
      if (space_.normalize(q.data()) &&
          kinematics::T_base_transfer(arm_, q).isApprox(T_base_transfer, kPrecision))
        return true;
    }
    return false;
  }

 private:
  unsigned dof() const { return static_cast<unsigned>(arm_.dof()); }

  const kinematics::Chain& arm_;
  inverse::JointSpace space_;
  KDL::Chain chain_;  // before the solver, which keeps a reference to it
  KDL::ChainIkSolverPos_LMA solver_;
  KDL::JntArray found_, start_;
  std::mt19937_64 generator_{2};
};

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  using namespace kinship;
  if (argc != 3)
    return 2;
  const kinematics::Chain arm = test::model_chain(argv[1]);
  bench::RestartedSolver solver(arm);
  int solved = 0, missed = 0;
  const std::vector<Eigen::Isometry3d> poses = bench::reachable_poses(arm, std::stoi(argv[2]));
  const double start_s = bench::thread_cpu_s();
  for (const Eigen::Isometry3d& T_base_transfer : poses)
    ++(solver.reaches(T_base_transfer) ? solved : missed);
  std::cout << solved / (bench::thread_cpu_s() - start_s) << ' ' << missed << '\n';
  return 0;
}
