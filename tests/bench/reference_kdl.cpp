#include <algorithm>
#include <functional>
#include <iomanip>
#include <iostream>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/robots.hpp"

// Inverse kinematics of ours and of KDL (Debian: liborocos-kdl-dev) at the same reachable poses of
// the five cobots, in one run: one thread, CPU time. KDL's solvers give one solution from one
// start; they are started again at random, as users do, until a solution within the limits passes
// the same check as ours, or kRestarts are used up.
//
//   kdl_compare [poses]
namespace kinship {
namespace {

constexpr int kRestarts = 100;
constexpr unsigned kNewtonIterations = 100;  // KDL's own default
constexpr double kPrecision = 1e-6;

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

KDL::JntArray to_kdl(const Eigen::VectorXd& q) {
  KDL::JntArray values(static_cast<unsigned>(q.size()));
  values.data = q;
  return values;
}

/// One start, one solution or none.
using OneStart = std::function<bool(const KDL::JntArray&, const KDL::Frame&, KDL::JntArray&)>;

void print_row(const std::string& robot, const std::string& engine, std::size_t poses,
               double solutions, double missed, double taken_s) {
  std::cout << "| " << robot << " | " << engine << " | " << std::setprecision(1)
            << 1e6 * taken_s / static_cast<double>(poses) << " | " << std::setprecision(2)
            << solutions / static_cast<double>(poses) << " | "
            << 100 * missed / static_cast<double>(poses) << " % | " << std::setprecision(0)
            << solutions / taken_s << " |" << std::endl;
}

void print_peer(const std::string& robot, const std::string& engine, const kinematics::Chain& arm,
                const std::vector<Eigen::Isometry3d>& poses, const OneStart& solve) {
  const inverse::JointSpace space(arm);
  std::mt19937_64 generator(2);
  double solved = 0;
  const double start_s = thread_cpu_s();
  for (const Eigen::Isometry3d& T_base_transfer : poses) {
    const KDL::Frame wanted = to_kdl(T_base_transfer);
    KDL::JntArray found(static_cast<unsigned>(arm.dof()));
    for (int i = 0; i < kRestarts; ++i) {
      if (!solve(to_kdl(test::random_configuration(arm, generator)), wanted, found))
        continue;
      inverse::JointVector q = found.data;
      if (!space.normalize(q.data()) || !inverse::reaches(arm, T_base_transfer, q))
        continue;
      ++solved;
      break;
    }
  }
  print_row(robot, engine, poses.size(), solved, static_cast<double>(poses.size()) - solved,
            thread_cpu_s() - start_s);
}

void print_ours(const std::string& robot, const kinematics::Chain& arm,
                const std::vector<Eigen::Isometry3d>& poses, int most) {
  const inverse::Solver solver(arm);
  double solutions = 0, missed = 0;
  const double start_s = thread_cpu_s();
  for (const Eigen::Isometry3d& T_base_transfer : poses) {
    const auto found = solver.solve(T_base_transfer * arm.T_tip_transfer().inverse(),
                                    {.max_solutions = most, .min_distance = 0.2});
    solutions += static_cast<double>(found.configurations.cols());
    missed += found.configurations.cols() == 0 ? 1 : 0;
  }
  print_row(robot, "ours, L = " + std::to_string(most), poses.size(), solutions, missed,
            thread_cpu_s() - start_s);
}

void compare(const std::string& robot, int count) {
  const kinematics::Chain arm = test::model_chain(robot);
  std::mt19937_64 generator(1);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i)
    poses.push_back(kinematics::T_base_transfer(arm, test::random_configuration(arm, generator)));
  print_ours(robot, arm, poses, 8);
  print_ours(robot, arm, poses, 1);
  const KDL::Chain chain = to_kdl(arm);
  KDL::ChainIkSolverPos_LMA lma(chain, kPrecision / 10);
  print_peer(robot, "KDL LMA", arm, poses,
             [&](const KDL::JntArray& start, const KDL::Frame& wanted, KDL::JntArray& found) {
               return lma.CartToJnt(start, wanted, found) >= 0;
             });
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainIkSolverVel_pinv velocity(chain);
  KDL::ChainIkSolverPos_NR_JL newton(chain, to_kdl(arm.lower()), to_kdl(arm.upper()), forward,
                                     velocity, kNewtonIterations, kPrecision / 10);
  print_peer(robot, "KDL NR_JL", arm, poses,
             [&](const KDL::JntArray& start, const KDL::Frame& wanted, KDL::JntArray& found) {
               return newton.CartToJnt(start, wanted, found) >= 0;
             });
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::stoi(argv[1]) : 1000;
  std::cout << std::fixed
            << "| Robot | Engine | us/pose | solutions/pose | missed | solutions/s |\n"
               "|---|---|---|---|---|---|\n";
  for (const char* robot : {"ur10e", "iiwa14", "panda", "sawyer", "sara_like"})
    kinship::compare(robot, count);
}
