#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"

namespace kinship::inverse::inverse_low_rank_test {
namespace {

using kinematics::Chain;
using kinematics::JointType;
using test::Line;

constexpr std::uint64_t kSeed = 30;
constexpr int kPoses = 1000;

/// Chains of which some joints do what others do already: telescopes (sliding joints side by side),
/// hinges that turn about one line, fans (parallel axes) and ball joints of more than three.
class LowRankChains {
 public:
  explicit LowRankChains(std::uint64_t seed) : generator_(seed) {}

  /// \return one whose joints move it in fewer directions than there are joints.
  Chain draw() {
    while (true) {
      lines_.clear();
      point_ = Eigen::Vector3d::Zero();
      add_group();
      while (lines_.size() < 4 || (lines_.size() < 8 && uniform(0, 1) < 0.7))
        uniform(0, 1) < 0.4 ? add_group()
                            : add(test::random_direction(generator_), uniform(0, 1) < 0.3);
      kinematics::ChainParts parts =
          test::parts_of(test::screw_arm(lines_, point_ + step(0.05, 0.2)));
      for (kinematics::Joint& joint : parts.joints)
        limit(joint);
      parts.T_tip_transfer = test::random_pose(0.1, generator_);
      Chain chain(std::move(parts));
      if (rank(chain) < chain.dof())
        return chain;
    }
  }

  std::mt19937_64& generator() { return generator_; }

  /// In how many directions the joints move the transfer frame at a random configuration.
  Eigen::Index rank(const Chain& chain) {
    const auto J = kinematics::J_base_tip(chain, test::random_configuration(chain, generator_));
    const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
    return (values.array() > 1e-9 * values[0]).count();
  }

 private:
  double uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(generator_);
  }

  Eigen::Vector3d step(double least_m, double most_m) {
    return uniform(least_m, most_m) * test::random_direction(generator_);
  }

  void add(const Eigen::Vector3d& direction, bool slides) {
    point_ += step(0.02, 0.4);
    lines_.push_back({point_, direction, slides ? JointType::Prismatic : JointType::Revolute, 1});
  }

  void add_group() {
    const Eigen::Vector3d direction = test::random_direction(generator_);
    const auto kind = static_cast<int>(uniform(0, 4));
    const int count = (kind < 2 ? 2 : 4) + (uniform(0, 1) < 0.3 ? 1 : 0);
    const Eigen::Vector3d at = point_ += step(0.02, 0.4);
    for (int i = 0; i < count; ++i) {
      if (kind == 0 || kind == 2)
        add(direction, kind == 0);
      else
        lines_.push_back({at, kind == 1 ? direction : test::random_direction(generator_)});
    }
  }

  /// As robots have them: not the same both ways, sliding joints of a few decimetres.
  void limit(kinematics::Joint& joint) {
    if (joint.type == JointType::Prismatic) {
      joint.lower = uniform(-0.2, 0.1);
      joint.upper = joint.lower + uniform(0.1, 0.6);
      return;
    }
    joint.lower = uniform(-std::numbers::pi, -0.5);
    joint.upper = uniform(0.5, std::numbers::pi);
  }

  std::mt19937_64 generator_;
  std::vector<Line> lines_;
  Eigen::Vector3d point_;
};

/// A letter for each joint: P slides, R turns.
std::string text(const Chain& chain) {
  std::string types;
  for (const kinematics::Joint& joint : chain.joints())
    types += joint.type == JointType::Prismatic ? 'P' : 'R';
  return types;
}

/// How many of the poses of random configurations are not solved.
int missed(const Chain& chain, int poses, std::mt19937_64& generator) {
  const Solver solver(chain);
  int count = 0;
  for (int i = 0; i < poses; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const Eigen::Isometry3d T_base_tip = kinematics::T_base_tip(chain, q);
    const auto found = solver.solve(T_base_tip);
    count += found.configurations.cols() == 0 ? 1 : 0;
    for (const auto& solution : found.configurations.colwise())
      EXPECT_TRUE(chain.within_limits(solution) &&
                  reaches(chain, T_base_tip * chain.T_tip_transfer(), solution))
          << solution.transpose();
  }
  return count;
}

TEST(InverseOfLowRank, EveryPoseOfTwentyRandomChainsIsSolved) {
  LowRankChains chains(kSeed);
  for (int i = 0; i < 20; ++i) {
    const Chain chain = chains.draw();
    EXPECT_TRUE(Solver(chain).redundant()) << "chain " << i << ", " << text(chain);
    EXPECT_EQ(missed(chain, kPoses, chains.generator()), 0)
        << "chain " << i << ", " << text(chain) << ", rank " << chains.rank(chain);
  }
}

/// \param skew  by which the second telescope is not parallel to the first, rad.
Chain lift_with_telescopes(double skew) {
  using test::arms::kX, test::arms::kY, test::arms::kZ;
  constexpr JointType kSlides = JointType::Prismatic, kTurns = JointType::Revolute;
  return test::screw_arm({{{0, 0, 0.5}, kZ, kSlides, 0.5},
                          {{0, 0, 0.5}, kX, kSlides, 0.2},
                          {{0.3, 0, 0.5}, kX + skew * kY, kSlides, 0.2},
                          {{0.6, 0, 0.5}, kZ, kTurns, 2.9},
                          {{0.6, 0, 0.5}, kY, kTurns, 1.9},
                          {{0.7, 0, 0.5}, kX, kTurns, 2.9}},
                         {0.8, 0, 0.5});
}

/// As many joints as task axes, and yet one of them is to spare.
TEST(InverseOfLowRank, ALiftWithTwoTelescopesAndAWristReachesWhatItReaches) {
  std::mt19937_64 generator(kSeed);
  EXPECT_EQ(missed(lift_with_telescopes(0), kPoses, generator), 0);
}

TEST(InverseOfLowRank, TelescopesThatAModelFileRoundsApartAreTelescopes) {
  std::mt19937_64 generator(kSeed);
  for (const double skew : {4e-6, 1e-4, 8e-4, 3e-3})
    EXPECT_EQ(missed(lift_with_telescopes(skew), kPoses, generator), 0) << skew;
}

}  // namespace
}  // namespace kinship::inverse::inverse_low_rank_test
