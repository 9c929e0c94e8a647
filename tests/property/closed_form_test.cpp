#include "robots/inverse/closed_form.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/joint_motion.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"

namespace kinship::inverse::closed_form_test {
namespace {

using test::distance;
using test::normalize;

constexpr std::uint64_t kSeed = 72;
constexpr double kSameBranch = 0.02;  // joint units
constexpr int kDescents = 1500;

/// The chain without a joint, which stays where it stands at `value`.
kinematics::Chain without_joint(const kinematics::Chain& chain, int joint, double value) {
  kinematics::ChainParts parts;
  parts.base_link = chain.base_link();
  parts.tip_link = chain.tip_link();
  parts.T_last_tip = chain.T_last_tip();
  parts.T_tip_transfer = chain.T_tip_transfer();
  Eigen::Isometry3d T_left_out = Eigen::Isometry3d::Identity();
  for (int j = 0; j < static_cast<int>(chain.dof()); ++j) {
    kinematics::Joint next = chain.joints()[static_cast<std::size_t>(j)];
    if (j == joint) {
      T_left_out = next.T_previous_joint;
      kinematics::move(next, value, T_left_out);
      continue;
    }
    next.T_previous_joint = T_left_out * next.T_previous_joint;
    T_left_out = Eigen::Isometry3d::Identity();
    parts.joints.push_back(next);
  }
  parts.T_last_tip = T_left_out * parts.T_last_tip;
  return kinematics::Chain(std::move(parts));
}

std::vector<Eigen::VectorXd> solutions_of_descents(const kinematics::Chain& chain,
                                                   const Eigen::Isometry3d& T_base_transfer,
                                                   std::mt19937_64& generator) {
  const Descent descent(chain);
  std::vector<Eigen::VectorXd> found;
  for (int i = 0; i < kDescents; ++i) {
    JointVector q = test::random_configuration(chain, generator);
    descent.run(T_base_transfer, Descent::Limits::Ignore, 40, q);
    Eigen::VectorXd solution = q;
    if (!normalize(chain, solution) || !reaches(chain, T_base_transfer, solution))
      continue;
    const bool known = std::ranges::any_of(found, [&](const Eigen::VectorXd& other) {
      return distance(chain, other, solution) < kSameBranch;
    });
    if (!known)
      found.push_back(solution);
  }
  return found;
}

/// Branches without their locked joint, those of nearly singular poses taken together.
std::vector<Eigen::VectorXd> distinct(const kinematics::Chain& six, const Branches& branches,
                                      int lock) {
  std::vector<Eigen::VectorXd> found;
  for (int b = 0; b < branches.size(); ++b) {
    Eigen::VectorXd branch(6);
    for (int j = 0, free = 0; free < 6; ++j)
      if (j != lock)
        branch[free++] = branches[b][j];
    EXPECT_TRUE(normalize(six, branch));
    const bool known = std::ranges::any_of(found, [&](const Eigen::VectorXd& other) {
      return distance(six, branch, other) < kSameBranch;
    });
    if (!known)
      found.push_back(branch);
  }
  return found;
}

struct Subject {
  std::string name;
  std::function<kinematics::Chain()> chain;
};

class BranchCount : public testing::TestWithParam<Subject> {};

TEST_P(BranchCount, IsThatOfManyDescents) {
  const kinematics::Chain chain = GetParam().chain();
  const auto form = find_closed_form(chain).form;
  ASSERT_TRUE(form);
  ASSERT_LE(form->locks().size(), 1U);
  std::mt19937_64 generator(kSeed);
  for (int pose = 0; pose < 8; ++pose) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
    const int lock = form->locks().empty() ? -1 : form->locks()[0];
    const double locked = lock < 0 ? 0 : q[lock];
    Branches branches;
    form->append(T, {&locked, form->locks().size()}, branches);
    const kinematics::Chain six = lock < 0 ? chain : without_joint(chain, lock, locked);
    const auto expected = solutions_of_descents(six, T, generator);
    EXPECT_FALSE(expected.empty());
    const auto found = distinct(six, branches, lock);
    EXPECT_EQ(found.size(), expected.size()) << q.transpose();
    for (const Eigen::VectorXd& solution : expected) {
      const bool known = std::ranges::any_of(found, [&](const Eigen::VectorXd& branch) {
        return distance(six, branch, solution) < kSameBranch;
      });
      EXPECT_TRUE(known) << solution.transpose();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Arms, BranchCount,
    testing::Values(Subject{"ur10e", [] { return test::model_chain("ur10e"); }},
                    Subject{"iiwa14", [] { return test::model_chain("iiwa14"); }},
                    Subject{"panda", [] { return test::model_chain("panda"); }},
                    Subject{"industrial", test::arms::industrial},
                    Subject{"hollow_wrist", test::arms::hollow_wrist},
                    Subject{"spherical_shoulder", test::arms::spherical_shoulder},
                    Subject{"on_track", test::arms::on_track}),
    [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace kinship::inverse::closed_form_test
