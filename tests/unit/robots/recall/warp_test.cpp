#include "robots/recall/warp.hpp"

#include <gtest/gtest.h>

#include <random>

#include "robots/inverse/descent.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/recall/clear_path.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

namespace kinship::recall::warp_test {
namespace {

constexpr std::uint64_t kSeed = 32;

/// A curved way from one configuration to another one.
Eigen::MatrixXd curve(const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  Eigen::MatrixXd path(from.size(), 3);
  path << from, (from + to) / 2, to;
  path(0, 1) += 0.2;
  path(1, 1) -= 0.2;
  return equal_parts(path);
}

WarpTarget target_of(const Warper& warper, const Eigen::VectorXd& start,
                     const Eigen::VectorXd& goal) {
  const kinematics::Chain& chain = warper.chain();
  return {planning::planning_bounds(chain, start), start, goal,
          kinematics::T_base_transfer(chain, start), kinematics::T_base_transfer(chain, goal)};
}

/// All waypoints, in the order in which they are asked for.
Eigen::MatrixXd computed(Warp warp) {
  for (const Eigen::Index stride : {4, 1})
    warp.compute(stride);
  return warp.waypoints();
}

Eigen::VectorXd panda_start() { return Eigen::VectorXd{{0, -0.785, 0, -2.356, 0, 1.571, 0.785}}; }
Eigen::VectorXd panda_goal() { return Eigen::VectorXd{{0.5, 0.1, 0.2, -1.8, 0.1, 2.2, 1.1}}; }

class Warps : public testing::TestWithParam<std::size_t> {
 protected:
  const WarpBlend& blend() const { return kWarpBlends.at(GetParam()); }
};

TEST_P(Warps, StartAndEndInTheQuerysAndStayWithinBounds) {
  std::mt19937_64 generator(kSeed);
  for (const char* const robot : {"panda", "ur10e"}) {
    const Warper warper(test::model_chain(robot));
    const auto random = [&] { return test::random_configuration(warper.chain(), generator); };
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 50; ++i) {
      const Eigen::VectorXd from = random(), start = random();
      const Eigen::Matrix2Xd bounds = planning::planning_bounds(warper.chain(), start);
      const Eigen::VectorXd goal =
          random().cwiseMax(bounds.row(0).transpose()).cwiseMin(bounds.row(1).transpose());
      const WarpedPath path = warper.posed(curve(from, random()));
      const Eigen::Isometry3d T_new_old(
          Eigen::Translation3d(unit(generator), unit(generator), unit(generator)) *
          Eigen::AngleAxisd(unit(generator), Eigen::Vector3d::UnitZ()));
      for (const auto& moved : {std::optional(T_new_old), std::optional<Eigen::Isometry3d>()}) {
        const Eigen::MatrixXd q =
            computed(Warp(warper, path, target_of(warper, start, goal), blend(), moved));
        ASSERT_EQ(q.cols(), kRecallWaypoints);
        EXPECT_EQ(q.col(0), start);
        EXPECT_EQ(q.rightCols<1>(), goal);
        EXPECT_TRUE(q.allFinite());
        EXPECT_TRUE((q.colwise() - bounds.row(0).transpose().eval()).minCoeff() >= 0);
        EXPECT_TRUE((q.colwise() - bounds.row(1).transpose().eval()).maxCoeff() <= 0);
      }
    }
  }
}

TEST_P(Warps, OntoTheirOwnQueryAreThePath) {
  const Warper warper(test::model_chain("panda"));
  const WarpedPath path = warper.posed(curve(panda_start(), panda_goal()));
  const Eigen::MatrixXd q =
      computed(Warp(warper, path, target_of(warper, panda_start(), panda_goal()), blend(),
                    Eigen::Isometry3d::Identity()));
  EXPECT_LT((q - path.waypoints).cwiseAbs().maxCoeff(), 1e-6);
}

/// The start stays, furniture and goal move: once the motion has gone over, the hand is where it
/// was with respect to the furniture.
TEST_P(Warps, KeepTheHandsWayInTheFrameThatMoved) {
  const Warper warper(test::model_chain("panda"));
  const kinematics::Chain& chain = warper.chain();
  const WarpedPath path = warper.posed(curve(panda_start(), panda_goal()));
  const inverse::Descent descent(chain);
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d T_new_old(
        Eigen::Translation3d(0.05 * unit(generator), 0.1 * unit(generator), 0.0) *
        Eigen::AngleAxisd(0.2 * unit(generator), Eigen::Vector3d::UnitZ()));
    inverse::JointVector goal = panda_goal();
    descent.run(T_new_old * path.T_base_transfer.back(), inverse::Descent::Limits::Hold, 100, goal);
    ASSERT_TRUE(inverse::reaches(chain, T_new_old * path.T_base_transfer.back(), goal));
    for (const auto& moved : {std::optional(T_new_old), std::optional<Eigen::Isometry3d>()}) {
      const Eigen::MatrixXd q =
          computed(Warp(warper, path, target_of(warper, panda_start(), goal), blend(), moved));
      for (Eigen::Index at = 0; at < q.cols(); ++at) {
        const double part = static_cast<double>(at) / static_cast<double>(q.cols() - 1);
        if (part < blend().end)
          continue;
        const Eigen::Isometry3d hand = kinematics::T_base_transfer(chain, q.col(at));
        const Eigen::Isometry3d wanted =
            T_new_old * path.T_base_transfer[static_cast<std::size_t>(at)];
        EXPECT_LT((hand.translation() - wanted.translation()).norm(), 0.015) << at;
        EXPECT_LT(Eigen::AngleAxisd(hand.linear().transpose() * wanted.linear()).angle(), 0.05);
      }
    }
  }
}

TEST_P(Warps, MoveAJointOfSeveralTurnsByFullTurns) {
  const Warper warper(test::model_chain("ur10e"));
  const Eigen::VectorXd from{{-1, -1.2, 1.5, -1.9, -1.5, -2}},
      to{{-0.4, -0.9, 1.2, -1.8, -1.4, -1}};
  const WarpedPath path = warper.posed(curve(from, to));
  Eigen::VectorXd turns = Eigen::VectorXd::Zero(6);
  turns[0] = turns[5] = planning::kTurn;
  const Eigen::MatrixXd q = computed(Warp(warper, path, target_of(warper, from + turns, to + turns),
                                          blend(), Eigen::Isometry3d::Identity()));
  EXPECT_LT((q - (path.waypoints.colwise() + turns)).cwiseAbs().maxCoeff(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(EachBlend, Warps, testing::Range<std::size_t>(0, kMaxWarpBlends));

TEST(Warper, JointsWithoutATurnOfRoomHaveNoTurns) {
  const Warper panda(test::model_chain("panda")), ur(test::model_chain("ur10e"));
  EXPECT_EQ(panda.turns(0, -2.8, 2.8), 0);
  EXPECT_EQ(ur.turns(0, -5, 5), planning::kTurn * 2);
  EXPECT_EQ(ur.turns(0, 0.5, -0.5), 0);
}

TEST(Warper, TheJointThatTurnsTheWholeArmIsTheFirstIfItIsVertical) {
  EXPECT_EQ(Warper(test::model_chain("panda")).yaw_joint(), 0);
  test::PlanarArm sliding{{0.4, 0.3}};
  sliding.type = kinematics::JointType::Prismatic;
  EXPECT_EQ(Warper(sliding.chain()).yaw_joint(), -1);
}

}  // namespace
}  // namespace kinship::recall::warp_test
