#include "client/ompl/ompl_planner.hpp"

#include <gtest/gtest.h>

#include "tests/unit/robots/planning/carrying_problem.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::ompl_planners::ompl_planner_test {
namespace {

using planning::ConfigurationSampler;
using planning::ConstrainedFreedom;
using planning::IsFree;
using planning::NoPath;
using planning::PlanSummary;
using planning::RegionConstraint;
using namespace planning::test_support;

OmplOptions options(const std::string& planner) {
  OmplOptions options;
  options.planner = planner;
  options.limits.step = kStep;
  options.limits.max_checks = 50'000;
  options.limits.time_limit = std::chrono::seconds(60);
  return options;
}

ConfigurationSampler gap_sampler(double share) {
  test::PlanarArm arm;
  arm.lengths_m = {1, 1};
  arm.limit = 1;
  Eigen::Matrix2d covariance;
  covariance << 0.04, 0, 0, 0.0009;
  return {square_bounds(), arm.chain(), Mixture(Eigen::VectorXd::Ones(1), at(0, 0.7), {covariance}),
          share};
}

/// A world that remembers what it was asked.
struct Witness {
  WallWorld world;
  std::vector<Eigen::VectorXd> asked;

  IsFree is_free() {
    return [this](const Eigen::VectorXd& q) {
      asked.push_back(q);
      return world.free_at(q);
    };
  }
  double distance_to_asked(const Eigen::VectorXd& q) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::VectorXd& other : asked)
      nearest = std::min(nearest, (q - other).norm());
    return nearest;
  }
};

PlanSummary plan(const std::string& planner, Witness& witness, const Eigen::MatrixXd& goals,
                 const OmplOptions& with) {
  std::mt19937_64 generator(3);
  OmplOptions named = with;
  named.planner = planner;
  return plan_with_ompl(kStart, goals, witness.is_free(), gap_sampler(0.7), named, generator);
}

class EveryOmplPlanner : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, EveryOmplPlanner, testing::ValuesIn(ompl_planner_names()),
                         [](const auto& named) { return named.param; });

TEST_P(EveryOmplPlanner, FindsCheckedWaypointsAStepApart) {
  Witness witness;
  const PlanSummary summary = plan(GetParam(), witness, kGoal, options(""));
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  const Eigen::MatrixXd& path = *summary.waypoints;
  EXPECT_EQ(path.col(0), kStart);
  EXPECT_EQ(path.rightCols<1>(), kGoal);
  EXPECT_EQ(summary.collision_checks, witness.asked.size());
  EXPECT_EQ(summary.reason, NoPath::None);
  for (Eigen::Index i = 0; i < path.cols(); ++i) {
    EXPECT_TRUE(witness.world.free_at(path.col(i)));
    EXPECT_LT(witness.distance_to_asked(path.col(i)), 1e-9);
    if (i > 0) {
      EXPECT_LE((path.col(i) - path.col(i - 1)).norm(), kStep + 1e-9);
      EXPECT_GT((path.col(i) - path.col(i - 1)).norm(), 0);
    }
  }
}

TEST_P(EveryOmplPlanner, ReachesTheGoalThatCanBeReached) {
  Eigen::MatrixXd goals(2, 3);
  goals << at(0, -0.5), at(0.05, 0.9), kGoal;  // in the wall twice
  Witness witness;
  const PlanSummary summary = plan(GetParam(), witness, goals, options(""));
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_EQ(summary.waypoints->rightCols<1>(), kGoal);
}

TEST_P(EveryOmplPlanner, AsksNothingBeyondItsBudget) {
  for (const std::uint64_t limit : {0u, 1u, 2u, 300u}) {
    Witness witness;
    witness.world.gap_upper = witness.world.gap_lower;  // never solved
    OmplOptions limited = options("");
    limited.limits.max_checks = limit;
    const PlanSummary summary = plan(GetParam(), witness, kGoal, limited);
    EXPECT_FALSE(summary.waypoints);
    EXPECT_EQ(summary.reason, NoPath::MaxChecks);
    EXPECT_EQ(witness.asked.size(), limit);
    EXPECT_EQ(summary.collision_checks, limit);
  }
}

TEST_P(EveryOmplPlanner, TriesEveryGoal) {
  // The nearer goal lies in a cell that nothing leads into.
  Eigen::MatrixXd goals(2, 2);
  goals << at(-0.8, 0.9), kGoal;
  std::mt19937_64 generator(5);
  const WallWorld world;
  const IsFree is_free = [&](const Eigen::VectorXd& q) {
    const double from_cell = (q - at(-0.8, 0.9)).cwiseAbs().maxCoeff();
    return world.free_at(q) && (from_cell < 0.02 || from_cell > 0.15);
  };
  const PlanSummary summary =
      plan_with_ompl(kStart, goals, is_free, gap_sampler(0.7), options(GetParam()), generator);
  ASSERT_TRUE(summary.waypoints) << describe(summary.reason);
  EXPECT_EQ(summary.waypoints->rightCols<1>(), kGoal);
}

TEST(OmplPlanner, StopsInTime) {
  Witness witness;
  witness.world.gap_upper = witness.world.gap_lower;
  OmplOptions limited = options("");
  limited.limits.max_checks = std::numeric_limits<std::uint64_t>::max();
  limited.limits.time_limit = std::chrono::milliseconds(20);
  EXPECT_EQ(plan("RRTConnect", witness, kGoal, limited).reason, NoPath::TimeLimit);
}

TEST(OmplPlanner, SaysWhyItDidNotPlan) {
  Witness witness;
  EXPECT_EQ(plan("RRT", witness, at(0, 0), options("")).reason, NoPath::GoalsCollide);
  EXPECT_EQ(plan("RRT", witness, Eigen::MatrixXd(2, 0), options("")).reason, NoPath::NoGoal);
  const PlanSummary there = plan("RRT", witness, kStart, options(""));
  ASSERT_TRUE(there.waypoints);
  EXPECT_EQ(there.waypoints->cols(), 2);
  witness.world.half_thickness = 0.9;
  EXPECT_EQ(plan("RRT", witness, kGoal, options("")).reason, NoPath::StartCollides);
}

TEST(OmplPlanner, RefusesAnUnknownNameWithThoseThereAre) {
  Witness witness;
  try {
    plan("KPIECE1", witness, kGoal, options(""));
    FAIL();
  } catch (const std::invalid_argument& refusal) {
    const std::string message = refusal.what();
    EXPECT_NE(message.find("'KPIECE1'"), std::string::npos) << message;
    for (const std::string& name : ompl_planner_names())
      EXPECT_NE(message.find(name), std::string::npos) << message;
  }
  OmplOptions backwards = options("");
  backwards.range = -1;
  EXPECT_THROW(plan("RRT", witness, kGoal, backwards), std::invalid_argument);
  EXPECT_TRUE(witness.asked.empty());
}

TEST(OmplPlanner, FollowsAThinRegion) {
  const LineArm arm;
  for (const char* name : {"RRT", "RRTConnect", "PRM", "LazyPRM"})
    for (const double step : {0.05, 0.3}) {
      RegionConstraint constraint = arm.constraint();
      std::mt19937_64 generator(1);
      std::uint64_t asked = 0;
      const IsFree is_free = [&](const Eigen::VectorXd& q) {
        ++asked;
        return constraint.holds(q);
      };
      OmplOptions stepped = options(name);
      stepped.limits.step = step;
      const auto summary = plan_with_ompl(LineArm::at_height(-1), LineArm::at_height(1),
                                          ConstrainedFreedom{is_free, constraint},
                                          ConfigurationSampler(arm.bounds), stepped, generator);
      ASSERT_TRUE(summary.waypoints)
          << name << ": " << describe(summary.reason) << " at step " << step;
      EXPECT_EQ(summary.collision_checks, asked);
      EXPECT_EQ(summary.projections, constraint.projections());
      EXPECT_EQ(summary.waypoints->col(0), LineArm::at_height(-1));
      EXPECT_EQ(summary.waypoints->rightCols<1>(), LineArm::at_height(1));
      EXPECT_LE(largest_excess(*summary.waypoints, constraint, 1),
                RegionConstraint::kWaypointTolerance);
      EXPECT_LE(largest_excess(*summary.waypoints, constraint, 20),
                RegionConstraint::kBetweenTolerance);
      for (Eigen::Index i = 1; i < summary.waypoints->cols(); ++i)
        EXPECT_LE((summary.waypoints->col(i) - summary.waypoints->col(i - 1)).norm(), step + 1e-8);
    }
}

TEST(OmplPlanner, AsksAboutTheConstraintFirst) {
  const LineArm arm;
  RegionConstraint constraint = arm.constraint();
  std::mt19937_64 generator(1);
  const IsFree never = [](const Eigen::VectorXd&) {
    ADD_FAILURE();
    return true;
  };
  const Eigen::VectorXd off = Eigen::Vector2d(0, 0);
  EXPECT_EQ(plan_with_ompl(off, LineArm::at_height(1), ConstrainedFreedom{never, constraint},
                           ConfigurationSampler(arm.bounds), options("RRT"), generator)
                .reason,
            NoPath::StartOffConstraint);
}

TEST(OmplPlanner, ConstrainedWaypointsAreThoseThatWereAsked) {
  const LineArm arm;
  RegionConstraint constraint = arm.constraint();
  for (const std::string& name : ompl_planner_names()) {
    std::mt19937_64 generator(2);
    Witness witness;
    const IsFree is_free = [&](const Eigen::VectorXd& q) {
      witness.asked.push_back(q);
      return true;
    };
    const auto summary = plan_with_ompl(LineArm::at_height(-0.5), LineArm::at_height(0.5),
                                        ConstrainedFreedom{is_free, constraint},
                                        ConfigurationSampler(arm.bounds), options(name), generator);
    ASSERT_TRUE(summary.waypoints) << name << ": " << describe(summary.reason);
    for (const auto& q : summary.waypoints->colwise())
      EXPECT_EQ(witness.distance_to_asked(q), 0) << name;
  }
}

}  // namespace
}  // namespace kinship::ompl_planners::ompl_planner_test
