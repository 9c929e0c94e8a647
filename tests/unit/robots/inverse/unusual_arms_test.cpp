#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "robots/inverse/closed_form.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::unusual_arms_test {
namespace {

using kinematics::Chain;
using kinematics::JointType;
using kinematics::T_base_tip;
using test::Line;
using test::arms::kX, test::arms::kY, test::arms::kZ;
constexpr std::uint64_t kSeed = 43;

/// How many of random configurations are among all solutions of their poses.
int recovered(const Chain& chain, int poses, std::mt19937_64& generator) {
  const Solver solver(chain);
  int count = 0;
  for (int i = 0; i < poses; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    count += holds(chain, checked(chain, solver, T_base_tip(chain, q)), q) ? 1 : 0;
  }
  return count;
}

Chain with_slide(const Chain& chain, std::size_t at) {
  kinematics::ChainParts parts = test::parts_of(chain);
  parts.joints[at].type = JointType::Prismatic;
  parts.joints[at].lower = -0.2;
  parts.joints[at].upper = 0.4;
  return Chain(std::move(parts));
}

TEST(UnusualArms, ASlidingJointFirstInTheMiddleAndLast) {
  std::mt19937_64 generator(kSeed);
  int count = 0;
  for (const std::size_t at : {0U, 1U, 2U, 3U, 4U, 5U})
    count += recovered(with_slide(test::random_chain({}, generator), at), 4, generator);
  EXPECT_GE(count, 22) << "of 24";
}

/// Two ways round the shoulder, two of the wrist: the slide is too short to point backwards.
TEST(UnusualArms, ACraneHasFourBranches) {
  const Chain chain = test::screw_arm({{{0, 0, 0.4}, kZ},
                                       {{0, 0.15, 0.4}, kY},
                                       {{0, 0.15, 0.4}, kX, JointType::Prismatic, 0.4},
                                       {{0.5, 0.15, 0.4}, kX},
                                       {{0.5, 0.15, 0.4}, kY},
                                       {{0.5, 0.15, 0.4}, kX}},
                                      {0.6, 0.15, 0.4});
  const Solver solver(chain);
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 8; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const auto found = checked(chain, solver, T_base_tip(chain, q));
    EXPECT_EQ(found.configurations.cols(), 4) << q.transpose();
    EXPECT_TRUE(holds(chain, found, q)) << q.transpose();
  }
}

/// The lines of tests::arms::industrial, one of them twice.
Chain with_twice(std::size_t joint, double direction) {
  std::vector<Line> lines = {{{0, 0, 0.4}, kZ},    {{0.35, 0, 0.8}, kY}, {{0.35, 0, 1.8}, kY},
                             {{0.5, 0, 1.95}, kX}, {{1.8, 0, 1.95}, kY}, {{2, 0, 1.95}, kX}};
  Line again = lines[joint];
  again.point += 0.1 * again.direction;
  again.direction *= direction;
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(joint) + 1, again);
  return test::screw_arm(lines, {2.2, 0, 1.95});
}

/// Both joints together do what the one of the arm without the second does: eight branches, in
/// which they share it as they like.
TEST(UnusualArms, TwoJointsOnTheSameAxisWorkAsOne) {
  const Chain six = test::arms::industrial();
  const Solver six_solver(six);
  std::mt19937_64 generator(kSeed);
  for (const std::size_t joint : {0U, 2U, 5U})
    for (const double direction : {1.0, -1.0}) {
      const Chain chain = with_twice(joint, direction);
      const Solver solver(chain);
      const auto as_one = [&](const Eigen::VectorXd& q) {
        Eigen::VectorXd merged(6);
        const auto before = static_cast<Eigen::Index>(joint) + 1;
        merged << q.head(before), q.tail(6 - before);
        merged[before - 1] += direction * q[before];
        return merged;
      };
      for (int i = 0; i < 3; ++i) {
        const Eigen::VectorXd q = test::random_configuration(chain, generator);
        const Eigen::Isometry3d T = T_base_tip(chain, q);
        const auto branches = checked(six, six_solver, T);
        EXPECT_TRUE(holds(six, branches, as_one(q)));
        const auto found = checked(chain, solver, T, {});
        EXPECT_EQ(found.configurations.cols(), 8) << q.transpose();
        for (const auto& solution : found.configurations.colwise())
          EXPECT_TRUE(holds(six, branches, as_one(solution))) << solution.transpose();
      }
    }
}

struct Subject {
  std::string name;
  std::function<Chain()> chain;
  bool closed;
};

class UnusualKindOf : public testing::TestWithParam<Subject> {
 protected:
  Chain chain_ = GetParam().chain();
  std::mt19937_64 generator_{kSeed};
  static constexpr int kPoses = 8;
  const int enough_ = GetParam().closed ? kPoses : kPoses - 1;
};

TEST_P(UnusualKindOf, OfAMillimetreAndOfThirtyMetres) {
  for (const double size : {1e-3, 30.0})
    EXPECT_GE(recovered(scaled(chain_, size), kPoses, generator_), enough_) << size;
}

TEST_P(UnusualKindOf, WithAToolOfSevenMetres) {
  kinematics::ChainParts parts = test::parts_of(chain_);
  parts.T_tip_transfer.translation() << 3, -4, 5;
  parts.T_tip_transfer.rotate(Eigen::AngleAxisd(0.7, kY));
  EXPECT_GE(recovered(Chain(std::move(parts)), kPoses, generator_), enough_);
}

INSTANTIATE_TEST_SUITE_P(Arms, UnusualKindOf,
                         testing::Values(Subject{"industrial", test::arms::industrial, true},
                                         Subject{"parallel", test::arms::parallel_forearm, true},
                                         Subject{"shoulder", test::arms::spherical_shoulder, true},
                                         Subject{"general", test::arms::general, false}),
                         [](const auto& instance) { return instance.param.name; });

Chain with_text(const std::string& model, const std::string& from, const std::string& to) {
  RobotDescription description = test::model_description(model);
  std::size_t at = description.urdf.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  for (; at != std::string::npos; at = description.urdf.find(from, at + to.size()))
    description.urdf.replace(at, from.size(), to);
  return kinematics::read_chain(description).value();
}

/// A quarter of a turn as model files write it: the axes that have to be parallel and to meet still
/// do, and the arm is solved as it is written.
TEST(UnusualArms, AQuarterTurnRoundedInTheModelFileKeepsTheStructure) {
  std::mt19937_64 generator(kSeed);
  for (const std::string digits : {"1.570796327", "1.5708", "1.57"}) {
    const Chain chain = with_text("ur10e", "1.570796327", digits);
    EXPECT_EQ(describe_structure(chain), "parallel axes 2-3-4; closed form, 8 branches") << digits;
    EXPECT_EQ(recovered(chain, 10, generator), 10) << digits;
  }
}

/// Half a turn of Sawyer is written as 3.1416: more off than a solution may be. It is the model
/// that counts, and not what it was meant to be.
TEST(UnusualArms, SawyersHalfTurnIsTakenAsItIsWritten) {
  const Chain written = test::model_chain("sawyer");
  const Chain meant = with_text("sawyer", "3.1416", "3.141592653589793");
  const Solver solver(written);
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 10; ++i) {
    const Eigen::VectorXd q = test::random_configuration(written, generator);
    const Eigen::Isometry3d T = T_base_tip(written, q);
    EXPECT_GT(pose_gap(meant, T, q), 5e-6);
    const auto found = checked(written, solver, T, {});
    EXPECT_GT(found.configurations.cols(), 0);
    for (const auto& solution : found.configurations.colwise())
      EXPECT_GT(pose_gap(meant, T, solution), 5e-6);
  }
}

TEST(UnusualArms, AnswersDependOnPoseAndSeedOnly) {
  for (const Chain& chain :
       {test::arms::industrial(), test::arms::general(), test::arms::on_track()}) {
    std::mt19937_64 generator(kSeed);
    const Solver solver(chain);
    std::vector<Eigen::Isometry3d> poses;
    std::vector<Eigen::MatrixXd> answers;
    for (int i = 0; i < 5; ++i) {
      poses.push_back(T_base_tip(chain, test::random_configuration(chain, generator)));
      answers.push_back(solver.solve(poses.back(), {.max_solutions = 3, .seed = 9}).configurations);
    }
    for (std::size_t i = poses.size(); i-- > 0;)
      EXPECT_EQ(Solver(chain).solve(poses[i], {.max_solutions = 3, .seed = 9}).configurations,
                answers[i]);
  }
}

}  // namespace
}  // namespace kinship::inverse::unusual_arms_test
