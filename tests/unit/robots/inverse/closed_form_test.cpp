#include "robots/inverse/closed_form.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::closed_form_test {
namespace {

using test::normalize;

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 20;

/// What a closed form proposes for a pose, the locked joints at their values in `q`.
Branches branches_at(const ClosedForm& form, const Eigen::Isometry3d& T, const Eigen::VectorXd& q) {
  std::vector<double> locked;
  for (const int joint : form.locks())
    locked.push_back(q[joint]);
  Branches branches;
  form.append(T, locked, branches);
  return branches;
}

Eigen::VectorXd configuration(const Branches& branches, int i, Eigen::Index dof) {
  return Eigen::Map<const Eigen::VectorXd>(branches[i], dof);
}

double pose_error(const kinematics::Chain& chain, const Eigen::VectorXd& q,
                  const Eigen::Isometry3d& T) {
  return (kinematics::T_base_transfer(chain, q).matrix() - T.matrix()).norm();
}

struct Arm {
  std::string name;
  std::function<kinematics::Chain()> chain;
  std::string words;
};

Arm model(const std::string& name, const std::string& words) {
  return {name, [name] { return test::model_chain(name); }, words};
}

class ClosedFormOf : public testing::TestWithParam<Arm> {
 protected:
  kinematics::Chain chain_ = GetParam().chain();
  ClosedFormFinding finding_ = find_closed_form(chain_);
  const ClosedForm& form_ = finding_.form ? *finding_.form : *finding_.left_out;
  std::mt19937_64 generator_{kSeed};
};

TEST_P(ClosedFormOf, IsDescribed) {
  const std::string words = describe_structure(chain_);
  EXPECT_EQ(words.substr(0, GetParam().words.size()), GetParam().words);
}

TEST_P(ClosedFormOf, GivesBackTheConfigurationAndReachesThePoseInEveryBranch) {
  for (int i = 0; i < 300; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain_, generator_);
    const Eigen::Isometry3d T = kinematics::T_base_transfer(chain_, q);
    const Branches branches = branches_at(form_, T, q);
    ASSERT_LE(branches.size(), form_.branches());
    bool recovered = false;
    for (int b = 0; b < branches.size(); ++b) {
      const Eigen::VectorXd found = configuration(branches, b, chain_.dof());
      EXPECT_LT(pose_error(chain_, found, T), 1e-8);
      recovered = recovered || turned_difference(chain_, found, q) < 1e-6;
      for (int other = 0; other < b; ++other)
        EXPECT_GT(turned_difference(chain_, found, configuration(branches, other, chain_.dof())),
                  1e-9);
    }
    EXPECT_TRUE(recovered) << q.transpose();
  }
}

/// The chain with a whole turn for every turning joint: every branch counts.
kinematics::Chain without_limits(const kinematics::Chain& chain) {
  kinematics::ChainParts parts = test::parts_of(chain);
  for (kinematics::Joint& joint : parts.joints)
    if (joint.type == kinematics::JointType::Revolute)
      joint.type = kinematics::JointType::Continuous;
  return kinematics::Chain(std::move(parts));
}

TEST_P(ClosedFormOf, LeavesOutWhatLimitsForbidAndNothingElse) {
  const kinematics::Chain free = without_limits(chain_);
  const ClosedFormFinding free_finding = find_closed_form(free);
  const ClosedForm& free_form = free_finding.form ? *free_finding.form : *free_finding.left_out;
  if (!std::ranges::equal(free_form.locks(), form_.locks()))
    GTEST_SKIP() << "locks other joints without limits";
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain_, generator_);
    const Eigen::Isometry3d T = kinematics::T_base_transfer(chain_, q);
    const Branches all = branches_at(free_form, T, q);
    EXPECT_FALSE(all.outside_limits());
    int inside = 0;
    for (int b = 0; b < all.size(); ++b) {
      Eigen::VectorXd branch = configuration(all, b, chain_.dof());
      inside += normalize(chain_, branch) ? 1 : 0;
    }
    const Branches allowed = branches_at(form_, T, q);
    EXPECT_EQ(allowed.size(), inside);
    EXPECT_TRUE(allowed.outside_limits() || inside == all.size());
  }
}

TEST_P(ClosedFormOf, SolvesPosesAtRoundAnglesAndBesideThem) {
  const kinematics::Chain free = without_limits(chain_);
  const ClosedFormFinding finding = find_closed_form(free);
  const ClosedForm& form = finding.form ? *finding.form : *finding.left_out;
  std::uniform_int_distribution<int> quarter(-1, 2);
  std::uniform_real_distribution<double> exponent(-12, -3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    Eigen::VectorXd q(chain_.dof());
    const double beside = i % 2 == 0 ? 0 : std::pow(10, exponent(generator_));
    for (double& value : q)
      value = 0.5 * kPi * quarter(generator_) + beside * normal(generator_);
    const Eigen::Isometry3d T = kinematics::T_base_transfer(chain_, q);
    const Branches branches = branches_at(form, T, q);
    double least = 1;
    for (int b = 0; b < branches.size(); ++b) {
      const Eigen::VectorXd found = configuration(branches, b, chain_.dof());
      ASSERT_TRUE(found.allFinite()) << q.transpose();
      least = std::min(least, pose_error(chain_, found, T));
    }
    EXPECT_LT(least, 1e-6) << q.transpose() << " beside " << beside;
  }
}

TEST_P(ClosedFormOf, GivesNothingForAPoseFarAway) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 30, 20, 0;
  EXPECT_EQ(branches_at(form_, T, Eigen::VectorXd::Zero(chain_.dof())).size(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Arms, ClosedFormOf,
    testing::Values(
        model("ur10e", "parallel axes 2-3-4; closed form, 8 branches"),
        model("iiwa14", "spherical wrist 5-6-7; lock q3; closed form, 8 branches per lock"),
        model("iiwa7", "spherical wrist 5-6-7; lock q3; closed form, 8 branches per lock"),
        model("sara_like", "spherical wrist 5-6-7; lock q3; closed form, 8 branches per lock"),
        model("panda", "spherical shoulder 1-2-3; lock q"),
        model("iiwa14_lift", "spherical wrist 6-7-8; lock q1, q"),
        model("planar_5r_a", "planar arm; lock q"), model("planar_7r_c", "planar arm; lock q"),
        Arm{"industrial", test::arms::industrial, "spherical wrist 4-5-6; closed form, 8 branches"},
        Arm{"hollow_wrist", test::arms::hollow_wrist, "spherical wrist 4-5-6; closed form, 8"},
        Arm{"late_shoulder", test::arms::late_shoulder, "spherical wrist 4-5-6; closed form, 8"},
        Arm{"horizontal", test::arms::horizontal, "spherical wrist 4-5-6; closed form, 8"},
        Arm{"spherical_shoulder", test::arms::spherical_shoulder, "spherical shoulder 1-2-3; c"},
        Arm{"parallel_forearm", test::arms::parallel_forearm, "parallel axes 3-4-5; closed form"},
        Arm{"on_track", test::arms::on_track, "parallel axes 3-4-5; lock q1; closed form"}),
    [](const auto& instance) { return instance.param.name; });

TEST(ClosedForm, IsTheSameWhereverJointsHaveTheirOriginsOnTheirLines) {
  const kinematics::Chain chain = test::arms::industrial();
  kinematics::ChainParts parts = test::parts_of(chain);
  double slid = 0;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (kinematics::Joint& joint : parts.joints) {
    slid += 0.7;
    joint.T_previous_joint.translation() += slid * joint.axis - before;
    before = slid * joint.axis;
  }
  parts.T_last_tip.translation() -= before;
  const kinematics::Chain moved(parts);
  EXPECT_EQ(describe_structure(moved), describe_structure(chain));
  Eigen::VectorXd q(6);
  q << 0.3, -0.5, 0.7, 1.1, -0.8, 0.2;
  const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
  ASSERT_LT(pose_error(moved, q, T), 1e-12);
  EXPECT_EQ(branches_at(*find_closed_form(moved).form, T, q).size(),
            branches_at(*find_closed_form(chain).form, T, q).size());
}

TEST(ClosedForm, NeverLocksTheElbowThatThePoseFixes) {
  for (const std::string name : {"iiwa7", "iiwa14", "sara_like"})
    for (const SixJointStructure& structure :
         six_joint_structures(axes_of(test::model_chain(name)))) {
      EXPECT_TRUE(structure.exact());
      EXPECT_NE(structure.locks, std::vector<int>{3}) << name;
    }
}

/// Each branch of a perturbed robot, polished, against the configuration that the pose is from.
TEST(ClosedForm, OfAPerturbedRobotIsAPolishAwayFromIt) {
  for (const auto& [sigma, share] : {std::pair{1e-4, 0.98}, {1e-3, 0.95}, {5e-3, 0.9}}) {
    std::mt19937_64 generator(kSeed);
    int recovered = 0;
    constexpr int kUnits = 10;
    constexpr int kPoses = 60;
    for (int unit = 0; unit < kUnits; ++unit) {
      const kinematics::Chain chain = test::perturbed(test::model_chain("ur10e"), sigma, generator);
      const auto form = find_closed_form(chain).form;
      ASSERT_TRUE(form) << sigma << ": " << describe_structure(chain);
      EXPECT_FALSE(form->exact());
      EXPECT_NEAR(form->deviation(), sigma, 3 * sigma);
      const Descent descent(chain);
      for (int i = 0; i < kPoses; ++i) {
        const Eigen::VectorXd q = test::random_configuration(chain, generator);
        const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
        const Branches branches = branches_at(*form, T, q);
        bool found = false;
        for (int b = 0; b < branches.size(); ++b) {
          JointVector polished = configuration(branches, b, 6);
          descent.run(T, Descent::Limits::Ignore, 10, polished);
          found = found ||
                  (reaches(chain, T, polished) && turned_difference(chain, polished, q) < 1e-4);
        }
        recovered += found ? 1 : 0;
      }
    }
    EXPECT_GE(recovered, share * kUnits * kPoses) << sigma;
  }
}

TEST(DescribeStructure, SaysNearlyAndByHowMuch) {
  std::mt19937_64 generator(kSeed);
  const std::string words =
      describe_structure(test::perturbed(test::model_chain("ur10e"), 1e-4, generator));
  EXPECT_EQ(words.find("nearly parallel axes 2-3-4 (off by "), 0U) << words;
  EXPECT_NE(words.find("closed form of the nominal chain and polish, 8 branches"),
            std::string::npos);
}

TEST(DescribeStructure, LocksALiftBelowAnArm) {
  EXPECT_TRUE(describe_structure(test::model_chain("panda_lift"))
                  .starts_with("spherical shoulder 2-3-4; lock q1, q7; closed form"));
}

TEST(DescribeStructure, SaysThatThereIsNoClosedForm) {
  EXPECT_EQ(describe_structure(test::model_chain("sawyer")), "no closed form; numeric");
  EXPECT_EQ(describe_structure(test::arms::general()),
            "no closed form; elimination and polish, at most 16 branches");
}

TEST(DescribeStructure, SaysWhatFewerJointsCannotDo) {
  using test::arms::kX, test::arms::kY, test::arms::kZ;
  const kinematics::Chain five = test::screw_arm({{{0, 0, 0.1}, kZ},
                                                  {{0, 0, 0.2}, kY},
                                                  {{0, 0, 0.5}, kY},
                                                  {{0, 0, 0.8}, kY},
                                                  {{0, 0, 0.9}, kZ}},
                                                 {0, 0, 1});
  EXPECT_EQ(describe_structure(five),
            "no closed form; numeric; 5 joints move the transfer frame in 5 of 6 task axes: poses "
            "off that set have no solution");
  const kinematics::Chain one = test::screw_arm({{{0, 0, 0.1}, kZ}}, {0.5, 0, 0.1});
  EXPECT_NE(describe_structure(one).find("1 joint moves the transfer frame in 1 of 6 task axes"),
            std::string::npos);
}

}  // namespace
}  // namespace kinship::inverse::closed_form_test
