#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/bench/closed_form_poses.hpp"
#include "tests/bench/cpu_time.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"

// Closed forms of inverse kinematics alone, before verification and choice: time per call,
// branches, and how well they reach the pose. Poses: forward kinematics of random configurations
// within the limits; locked joints at their true values. One thread, CPU time, best of several
// rounds.
//
//   closed_form_bench [poses]
namespace kinship {
namespace {

using inverse::Branches;
using inverse::ClosedForm;

constexpr int kRounds = 15;
constexpr double kRecovered = 1e-4;  // joint units

double best_us_per_call(const ClosedForm& form, const std::vector<LockedPose>& poses) {
  double best_s = 1e9;
  Branches branches;
  for (int round = 0; round < kRounds; ++round) {
    const double start_s = thread_cpu_s();
    for (const LockedPose& pose : poses) {
      branches.clear();
      form.append(pose.T_base_transfer, pose.locked, branches);
    }
    best_s = std::min(best_s, thread_cpu_s() - start_s);
  }
  return 1e6 * best_s / static_cast<double>(poses.size());
}

struct Quality {
  double branches = 0, recovered = 0;  ///< per pose
  std::vector<double> errors;          ///< of every branch, m and rad together
};

Quality quality(const kinematics::Chain& chain, const ClosedForm& form,
                const std::vector<LockedPose>& poses) {
  Quality result;
  for (const LockedPose& pose : poses) {
    Branches branches;
    form.append(pose.T_base_transfer, pose.locked, branches);
    bool recovered = false;
    for (int b = 0; b < branches.size(); ++b) {
      const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(branches[b], chain.dof());
      result.errors.push_back(
          (kinematics::T_base_transfer(chain, q).matrix() - pose.T_base_transfer.matrix()).norm());
      double largest = 0;
      for (Eigen::Index j = 0; j < q.size(); ++j)
        largest =
            std::max(largest, std::abs(std::remainder(q[j] - pose.q[j], 2 * std::numbers::pi)));
      recovered = recovered || largest < kRecovered;
    }
    result.branches += branches.size() / static_cast<double>(poses.size());
    result.recovered += (recovered ? 1.0 : 0.0) / static_cast<double>(poses.size());
  }
  std::ranges::sort(result.errors);
  return result;
}

void print(const std::string& name, const kinematics::Chain& chain, int count) {
  const double start_s = thread_cpu_s();
  const auto form = inverse::find_closed_form(chain).form;
  const double built_us = 1e6 * (thread_cpu_s() - start_s);
  std::cout << "| " << name << " | " << inverse::describe_structure(chain) << " | ";
  if (!form) {
    std::cout << "| | | | | |\n";
    return;
  }
  const std::vector<LockedPose> poses = locked_poses(chain, form->locks(), count);
  const Quality found = quality(chain, *form, poses);
  std::cout << std::fixed << std::setprecision(2) << best_us_per_call(*form, poses) << " | "
            << found.branches << " | " << form->mean_within_limits() << " | "
            << 100 * found.recovered << " % | " << std::scientific << std::setprecision(1)
            << found.errors[found.errors.size() * 99 / 100] << ", " << found.errors.back() << " | "
            << std::fixed << std::setprecision(0) << built_us << " |\n";
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  using namespace kinship;
  const int count = argc > 1 ? std::stoi(argv[1]) : 2000;
  std::cout
      << "| Robot | Found | us/call | branches within limits | the same, random locks | "
         "recovered | error: 99 %, worst | us to build |\n|---|---|---|---|---|---|---|---|\n";
  for (const char* model :
       {"ur10e", "iiwa14", "iiwa7", "sara_like", "panda", "sawyer", "planar_5r_a", "planar_7r_c"})
    print(model, test::model_chain(model), count);
  print("industrial", test::arms::industrial(), count);
  print("hollow wrist", test::arms::hollow_wrist(), count);
  print("spherical shoulder", test::arms::spherical_shoulder(), count);
  print("on a track", test::arms::on_track(), count);
  std::mt19937_64 generator(5);
  for (const double sigma : {1e-4, 1e-3, 5e-3}) {
    const std::string name = "ur10e, origins off by " + std::to_string(sigma);
    print(name, test::perturbed(test::model_chain("ur10e"), sigma, generator), count);
  }
}
