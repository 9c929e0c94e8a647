#include <EAIK.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robots/inverse/closed_form.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/bench/closed_form_poses.hpp"
#include "tests/bench/cpu_time.hpp"
#include "tests/support/robots.hpp"

// Closed forms of ours and of EAIK (Ostermeier et al.) at the same poses, in one run: forward
// kinematics of random configurations within the limits, locked joints at their true values. One
// thread, CPU time, best of several rounds. EAIK knows no limits and takes a new object for each
// value of a locked joint, whose building is told apart; what ours leaves out because of limits is
// counted in both.
//
//   eaik_compare [poses]
namespace kinship {
namespace {

constexpr int kRounds = 7;
constexpr double kRecovered = 1e-4;  // joint units
constexpr double kReached = 1e-6;    // m and rad together

/// A chain as EAIK wants it: axes, and the ways between points on them, with every joint at 0.
struct EaikArm {
  explicit EaikArm(const kinematics::Chain& chain)
      : H(3, chain.dof()), P(3, chain.dof() + 1), T_base_transfer(Eigen::Isometry3d::Identity()) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(chain.dof());
    T_base_transfer = kinematics::T_base_transfer(chain, zero);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    for (int j = 0; j < chain.dof(); ++j) {
      const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
      T = T * joint.T_previous_joint;
      H.col(j) = T.linear() * joint.axis;
      P.col(j) = T.translation() - last;
      last = T.translation();
    }
    P.col(chain.dof()) = T_base_transfer.translation() - last;
  }

  EAIK::Robot robot(std::span<const int> locks, const std::vector<double>& values) const {
    std::vector<std::pair<int, double>> fixed;
    for (std::size_t i = 0; i < locks.size(); ++i)
      fixed.emplace_back(locks[i], values[i]);
    return {H, P, T_base_transfer.linear(), fixed};
  }

  Eigen::MatrixXd H, P;
  Eigen::Isometry3d T_base_transfer;
};

bool within_limits(const kinematics::Chain& chain, const Eigen::VectorXd& q) {
  for (int j = 0; j < chain.dof(); ++j) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
    if (joint.type == kinematics::JointType::Continuous)
      continue;
    const double middle = 0.5 * (joint.lower + joint.upper);
    const double off = std::remainder(q[j] - middle, 2 * std::numbers::pi);
    if (std::abs(off) > 0.5 * (joint.upper - joint.lower) + kRecovered)
      return false;
  }
  return true;
}

/// What an engine gives per pose: branches that reach it, those within limits, and whether the one
/// that the pose came from is among them.
struct Found {
  double branches = 0, within = 0, recovered = 0, worst = 0;

  void count(const kinematics::Chain& chain, const LockedPose& pose,
             const std::vector<Eigen::VectorXd>& configurations) {
    bool again = false;
    for (const Eigen::VectorXd& q : configurations) {
      const double error =
          (kinematics::T_base_transfer(chain, q).matrix() - pose.T_base_transfer.matrix()).norm();
      if (error > kReached)
        continue;
      worst = std::max(worst, error);
      ++branches;
      within += within_limits(chain, q) ? 1 : 0;
      double largest = 0;
      for (Eigen::Index j = 0; j < q.size(); ++j)
        largest =
            std::max(largest, std::abs(std::remainder(q[j] - pose.q[j], 2 * std::numbers::pi)));
      again = again || largest < kRecovered;
    }
    recovered += again ? 1 : 0;
  }
};

double best_us(std::size_t poses, const std::function<void()>& round) {
  double best_s = 1e9;
  for (int i = 0; i < kRounds; ++i) {
    const double start_s = thread_cpu_s();
    round();
    best_s = std::min(best_s, thread_cpu_s() - start_s);
  }
  return 1e6 * best_s / static_cast<double>(poses);
}

void print_row(const std::string& robot, const std::string& engine, double call_us, double build_us,
               const Found& found, std::size_t poses) {
  const auto count = static_cast<double>(poses);
  std::cout << "| " << robot << " | " << engine << " | " << std::fixed << std::setprecision(2)
            << call_us << " | " << build_us << " | " << found.branches / count << " | "
            << found.within / count << " | " << 100 * found.recovered / count << " % | "
            << std::scientific << std::setprecision(0) << found.worst << " |" << std::endl;
}

void print_ours(const std::string& name, const kinematics::Chain& chain,
                const inverse::ClosedForm& form, const std::vector<LockedPose>& poses) {
  inverse::Branches branches;
  const auto call = [&](const LockedPose& pose) {
    branches.clear();
    form.append(pose.T_base_transfer, pose.locked, branches);
  };
  Found found;
  for (const LockedPose& pose : poses) {
    call(pose);
    std::vector<Eigen::VectorXd> configurations;
    for (int b = 0; b < branches.size(); ++b)
      configurations.emplace_back(Eigen::Map<const Eigen::VectorXd>(branches[b], chain.dof()));
    found.count(chain, pose, configurations);
  }
  const double call_us =
      best_us(poses.size(), [&] { std::for_each(poses.begin(), poses.end(), call); });
  print_row(name, "ours", call_us, 0, found, poses.size());
}

void print_eaik(const std::string& name, const kinematics::Chain& chain, std::span<const int> locks,
                const std::vector<LockedPose>& poses) {
  const EaikArm arm(chain);
  std::vector<EAIK::Robot> robots;  // one per value of the lock
  const std::size_t needed = locks.empty() ? 1 : poses.size();
  const double build_us = best_us(needed, [&] {
    robots.clear();
    for (std::size_t i = 0; i < needed; ++i)
      robots.push_back(arm.robot(locks, poses[i].locked));
  });
  const auto robot_of = [&](std::size_t i) -> const EAIK::Robot& {
    return robots[locks.empty() ? 0 : i];
  };
  Found found;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::vector<Eigen::VectorXd> configurations;
    const IKS::IK_Solution solution = robot_of(i).calculate_IK(poses[i].T_base_transfer.matrix());
    for (const std::vector<double>& q : solution.Q)
      configurations.emplace_back(
          Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size())));
    found.count(chain, poses[i], configurations);
  }
  std::size_t sink = 0;
  const double call_us = best_us(poses.size(), [&] {
    for (std::size_t i = 0; i < poses.size(); ++i)
      sink += robot_of(i).calculate_IK(poses[i].T_base_transfer.matrix()).Q.size();
  });
  print_row(name, sink > 0 ? "EAIK" : "EAIK (none)", call_us, build_us, found, poses.size());
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  using namespace kinship;
  const int count = argc > 1 ? std::stoi(argv[1]) : 2000;
  std::cout
      << "| Robot | Engine | us/call | us to build per lock value | branches that reach the "
         "pose | within limits | recovered | worst error |\n|---|---|---|---|---|---|---|---|\n";
  for (const char* model : {"ur10e", "iiwa14", "panda"}) {
    const kinematics::Chain chain = test::model_chain(model);
    const auto form = inverse::find_closed_form(chain).form;
    if (!form)
      continue;
    const std::vector<LockedPose> poses = locked_poses(chain, form->locks(), count);
    print_ours(model, chain, *form, poses);
    print_eaik(model, chain, form->locks(), poses);
  }
}
