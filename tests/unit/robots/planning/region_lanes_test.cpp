#include "robots/planning/region_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"
#include "tests/support/robots.hpp"

namespace kinship::planning::region_lanes_test {
namespace {

/// Regions through a configuration: upright, upright at a height, a hinge, a small box.
std::vector<TaskSpaceRegion> some_regions(const kinematics::Chain& chain,
                                          const Eigen::VectorXd& q) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  TaskSpaceRegion free;
  free.T_task_region = kinematics::T_base_transfer(chain, q);
  free.bounds.row(0).setConstant(-kInfinity);
  free.bounds.row(1).setConstant(kInfinity);
  std::vector<TaskSpaceRegion> regions(4, free);
  regions[0].bounds.middleCols<2>(3) << -0.15, -0.15, 0.15, 0.15;
  regions[1].bounds.middleCols<3>(2).setZero();
  regions[2].bounds.leftCols<5>().setZero();
  regions[2].T_region_end.translation() << 0.1, 0.3, 0;
  regions[2].T_task_region = regions[2].T_task_region * regions[2].T_region_end.inverse();
  regions[3].bounds.row(0).setConstant(-0.05);
  regions[3].bounds.row(1).setConstant(0.05);
  return regions;
}

/// Configurations near one.
Eigen::MatrixXd around(const Eigen::VectorXd& q, const Eigen::Matrix2Xd& bounds,
                       std::mt19937_64& generator) {
  std::normal_distribution<double> normal(0, 0.05);
  Eigen::MatrixXd qs =
      Eigen::MatrixXd::NullaryExpr(q.size(), kSideBySide, [&] { return normal(generator); })
          .colwise() +
      q;
  for (auto column : qs.colwise())
    column = column.cwiseMax(bounds.row(0).transpose()).cwiseMin(bounds.row(1).transpose());
  return qs;
}

TEST(RegionLanes, ProjectAsOneByOneWhateverStandsBeside) {
  std::mt19937_64 generator(3);
  int alone_only = 0, together_count = 0;
  for (const char* robot : {"panda", "ur10e", "panda_lift"}) {
    const kinematics::Chain chain = test::model_chain(robot);
    for (int i = 0; i < 50; ++i) {
      const Eigen::VectorXd q = test::random_configuration(chain, generator);
      const Eigen::Matrix2Xd bounds = planning_bounds(chain, q);
      for (const TaskSpaceRegion& region : some_regions(chain, q)) {
        RegionConstraint constraint(chain, region, Eigen::Isometry3d::Identity(), bounds);
        const Eigen::MatrixXd qs = around(q, bounds, generator);
        Eigen::MatrixXd projected = qs;
        const unsigned arrived = constraint.project_together(projected);
        for (Eigen::Index lane = 0; lane < kSideBySide; ++lane) {
          Eigen::VectorXd one = qs.col(lane);
          Eigen::MatrixXd single = one;
          const bool has_arrived = (arrived >> lane & 1U) != 0;
          EXPECT_EQ(constraint.project_together(single) == 1, has_arrived);
          EXPECT_EQ(single.col(0), projected.col(lane));
          EXPECT_TRUE((single.array() >= bounds.row(0).transpose().array()).all());
          EXPECT_TRUE((single.array() <= bounds.row(1).transpose().array()).all());
          together_count += has_arrived ? 1 : 0;
          EXPECT_TRUE(!has_arrived || constraint.holds(single.col(0)));
          alone_only += !has_arrived && constraint.project(one) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(together_count, 4000);
  EXPECT_LT(alone_only, 100);
}

TEST(RegionLanes, TellWhatIsWithinADistance) {
  std::mt19937_64 generator(4);
  constexpr double kDistance = 0.05, kDoubt = 1e-4;
  const kinematics::Chain chain = test::model_chain("panda");
  int within_count = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    const Eigen::Matrix2Xd bounds = planning_bounds(chain, q);
    for (const TaskSpaceRegion& region : some_regions(chain, q)) {
      const RegionConstraint constraint(chain, region, Eigen::Isometry3d::Identity(), bounds);
      const Eigen::MatrixXd qs = around(q, bounds, generator);
      const unsigned within = constraint.hold_together(qs, kDistance);
      for (Eigen::Index lane = 0; lane < kSideBySide; ++lane) {
        const double distance = constraint.distance(qs.col(lane));
        const bool is_within = (within >> lane & 1U) != 0;
        within_count += is_within ? 1 : 0;
        EXPECT_TRUE(is_within == (distance < kDistance) || std::abs(distance - kDistance) < kDoubt)
            << distance;
      }
    }
  }
  EXPECT_GT(within_count, 100);
  EXPECT_LT(within_count, 3100);
}

#ifdef __x86_64__
TEST(RegionLanes, AnswerAlikeOnAllInstructionSets) {
  if (!__builtin_cpu_supports("avx2"))
    GTEST_SKIP() << "no AVX2";
  std::mt19937_64 generator(5);
  const kinematics::Chain chain = test::model_chain("panda");
  std::uniform_real_distribution<float> angle(-3, 3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    for (const TaskSpaceRegion& region : some_regions(chain, q)) {
      const RegionConstraint constraint(chain, region, Eigen::Isometry3d::Identity(),
                                        planning_bounds(chain, q));
      alignas(32) float one[kLaneJoints * kSideBySide] = {}, other[kLaneJoints * kSideBySide];
      std::generate_n(one, chain.dof() * kSideBySide, [&] { return angle(generator); });
      std::ranges::copy(one, other);
      float squared[kSideBySide], others[kSideBySide];
      measure_lanes_sse2(constraint.lanes(), one, squared);
      measure_lanes_avx2(constraint.lanes(), other, others);
      EXPECT_TRUE(std::ranges::equal(squared, others));
      EXPECT_EQ(project_lanes_sse2(constraint.lanes(), one),
                project_lanes_avx2(constraint.lanes(), other));
      EXPECT_TRUE(std::ranges::equal(one, other));
    }
  }
}
#endif

}  // namespace
}  // namespace kinship::planning::region_lanes_test
