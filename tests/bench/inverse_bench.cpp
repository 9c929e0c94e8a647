#include <algorithm>
#include <functional>
#include <iomanip>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"

// Inverse kinematics at reachable poses: forward kinematics of random configurations within the
// limits. One thread, CPU time.
//
//   inverse_bench [poses]
namespace kinship {
namespace {

constexpr int kPasses = 5;
constexpr int kBranchPoses = 20;
constexpr int kIndependentSeeds = 10000;
constexpr double kSameBranch = 0.02;

std::vector<Eigen::Isometry3d> reachable_poses(const kinematics::Chain& chain, int count) {
  std::mt19937_64 generator(1);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i)
    poses.push_back(kinematics::T_base_tip(chain, test::random_configuration(chain, generator)));
  return poses;
}

struct Subject {
  std::string name;
  kinematics::Chain chain;
};

std::vector<Subject> subjects() {
  std::vector<Subject> result;
  for (const char* model :
       {"ur10e", "iiwa14", "panda", "sawyer", "sara_like", "planar_5r_a", "planar_7r_c"})
    result.push_back({model, test::model_chain(model)});
  std::mt19937_64 generator(6);
  for (int i = 1; i <= 3; ++i)
    result.push_back({"general 6R " + std::to_string(i), test::random_chain({}, generator)});
  return result;
}

struct RowNames {
  std::string robot, instructions, engine;
};

void print_row(const RowNames& names, int count, double taken_s, double solutions, double none) {
  std::cout << "| " << names.robot << " | " << names.instructions << " | " << names.engine << " | "
            << std::setprecision(1) << 1e6 * taken_s / count << " | " << std::setprecision(2)
            << solutions / count << " | " << 100 * none / count << " % | " << std::setprecision(0)
            << solutions / taken_s << " |\n";
}

void print_solver(const Subject& subject, const inverse::InstructionSet& set,
                  inverse::Solver::Engines engines, int count) {
  const inverse::Solver solver(subject.chain, set.kernels, engines);
  const std::vector<Eigen::Isometry3d> poses = reachable_poses(subject.chain, count);
  double solutions = 0, none = 0, taken_s = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < kPasses; ++pass) {  // the least: others may use the machine
    solutions = none = 0;
    const double start_s = thread_cpu_s();
    for (const Eigen::Isometry3d& T_base_tip : poses) {
      const auto found = solver.solve(T_base_tip, {.max_solutions = 8, .min_distance = 0.2});
      solutions += static_cast<double>(found.configurations.cols());
      none += found.configurations.cols() == 0 ? 1 : 0;
    }
    taken_s = std::min(taken_s, thread_cpu_s() - start_s);
  }
  const std::string engine = solver.closed_form() ? "closed form" : "descents";
  print_row({subject.name, std::string(set.name), engine}, count, taken_s, solutions, none);
}

/// The peer: descents one after the other, as they were before the lanes.
void print_scalar(const Subject& subject, int count) {
  const kinematics::Chain& chain = subject.chain;
  const inverse::Descent descent(chain);
  const inverse::JointSpace space(chain);
  std::mt19937_64 generator(2);
  double solutions = 0, none = 0;
  const std::vector<Eigen::Isometry3d> poses = reachable_poses(chain, count);
  const double start_s = thread_cpu_s();
  for (const Eigen::Isometry3d& T_base_tip : poses) {
    const Eigen::Isometry3d T_base_transfer = T_base_tip * chain.T_tip_transfer();
    std::vector<inverse::JointVector> found;
    for (int i = 0; i < 32 && found.size() < 8; ++i) {
      inverse::JointVector q = test::random_configuration(chain, generator);
      descent.run(T_base_transfer, inverse::Descent::Limits::Steer, 15, q);
      if (space.normalize(q.data()) && inverse::reaches(chain, T_base_transfer, q) &&
          std::ranges::all_of(found, [&](const inverse::JointVector& other) {
            return space.squared_distance(q.data(), other.data()) >= 0.04;
          }))
        found.push_back(q);
    }
    solutions += static_cast<double>(found.size());
    none += found.empty() ? 1 : 0;
  }
  print_row({subject.name, "scalar", "descents"}, count, thread_cpu_s() - start_s, solutions, none);
}

/// Solutions of one pose by another way than the solver's: one descent after the other.
std::vector<Eigen::VectorXd> independent_branches(const kinematics::Chain& chain,
                                                  const Eigen::Isometry3d& T_base_tip) {
  const inverse::Descent descent(chain);
  const inverse::JointSpace space(chain);
  const Eigen::Isometry3d T_base_transfer = T_base_tip * chain.T_tip_transfer();
  std::mt19937_64 generator(8);
  std::vector<Eigen::VectorXd> found;
  for (int i = 0; i < kIndependentSeeds; ++i) {
    inverse::JointVector q = test::random_configuration(chain, generator);
    descent.run(T_base_transfer, inverse::Descent::Limits::Ignore, 60, q);
    if (!space.normalize(q.data()) || !inverse::reaches(chain, T_base_transfer, q))
      continue;
    const bool known = std::ranges::any_of(found, [&](const Eigen::VectorXd& other) {
      return space.squared_distance(q.data(), other.data()) < kSameBranch * kSameBranch;
    });
    if (!known)
      found.emplace_back(q);
  }
  return found;
}

void print_branches(const Subject& subject) {
  const inverse::Solver solver(subject.chain);
  std::size_t expected = 0, recovered = 0, extra = 0;
  double taken_s = 0;
  for (const Eigen::Isometry3d& T_base_tip : reachable_poses(subject.chain, kBranchPoses)) {
    const double start_s = thread_cpu_s();
    const Eigen::MatrixXd all =
        solver.solve(T_base_tip, {.max_solutions = 64, .min_distance = kSameBranch}).configurations;
    taken_s += thread_cpu_s() - start_s;
    const auto branches = independent_branches(subject.chain, T_base_tip);
    std::size_t matched = 0;
    for (const Eigen::VectorXd& branch : branches)
      matched += ((all.colwise() - branch).colwise().norm().array() < kSameBranch).any() ? 1U : 0U;
    expected += branches.size();
    recovered += matched;
    const auto given = static_cast<std::size_t>(all.cols());
    extra += given - std::min(matched, given);
  }
  std::cout << "| " << subject.name << " | " << std::setprecision(2)
            << static_cast<double>(expected) / kBranchPoses << " | "
            << 100.0 * static_cast<double>(recovered) / static_cast<double>(expected) << " % | "
            << extra << " | " << std::setprecision(1) << 1e6 * taken_s / kBranchPoses << " |\n";
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  using namespace kinship;
  const int count = argc > 1 ? std::stoi(argv[1]) : 2000;
  std::cout << std::fixed
            << "| Robot | Instructions | Engine | us/pose | solutions/pose | without | "
               "configurations/s |\n"
               "|---|---|---|---|---|---|---|\n";
  const std::vector<Subject> all = subjects();
  for (const Subject& subject : all) {
    print_scalar(subject, std::min(count, 1000));
    for (const inverse::InstructionSet& set : inverse::instruction_sets()) {
      print_solver(subject, set, inverse::Solver::Engines::Descents, count);
      if (inverse::Solver(subject.chain, set.kernels, inverse::Solver::Engines::ClosedForm)
              .closed_form())
        print_solver(subject, set, inverse::Solver::Engines::ClosedForm, count);
    }
  }
  std::cout << "\n| Robot | Solver built in, us | Structure | within limits per lock |\n"
               "|---|---|---|---|\n";
  for (const Subject& subject : all) {
    const double start_s = thread_cpu_s();
    const inverse::Solver solver(subject.chain);
    const double taken_s = thread_cpu_s() - start_s;
    const inverse::ClosedForm* form = solver.closed_form();
    std::cout << "| " << subject.name << " | " << std::setprecision(0) << 1e6 * taken_s << " | "
              << (form != nullptr ? form->structure_name() : "descents") << " | "
              << std::setprecision(1) << (form != nullptr ? form->mean_within_limits() : 0)
              << " |\n";
  }
  std::cout << "\n| Robot | branches of 10 000 seeds | recovered | others | us/pose |\n"
               "|---|---|---|---|---|\n";
  for (const Subject& subject : all)
    if (subject.chain.dof() == 6)
      print_branches(subject);
}
