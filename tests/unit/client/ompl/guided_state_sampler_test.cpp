#include "client/ompl/guided_state_sampler.hpp"

#include <gtest/gtest.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/prm/LazyPRM.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <set>

#include "client/ompl/state_space.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::ompl_planners::guided_state_sampler_test {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using planning::ConfigurationSampler;
using planning::test_support::at;
using planning::test_support::kGoal;
using planning::test_support::kStart;
using planning::test_support::square_bounds;
using planning::test_support::WallWorld;

constexpr std::uint64_t kSeed = 23;

/// Samples only in the gap of the wall and at both sides of it.
std::shared_ptr<const ConfigurationSampler> gap_sampler(double share) {
  test::PlanarArm arm;
  arm.lengths_m = {1, 1};
  arm.limit = 1;
  Eigen::Matrix2d covariance;
  covariance << 0.04, 0, 0, 0.0009;
  const Mixture gap(Eigen::VectorXd::Ones(1), at(0, 0.7), {covariance});
  return std::make_shared<ConfigurationSampler>(square_bounds(), arm.chain(), gap, share);
}

bool near_gap(const Eigen::VectorXd& q) { return std::abs(q[1] - 0.7) < 0.15; }

/// OMPL among the walls, with its uniform sampler replaced.
struct WallProblem {
  explicit WallProblem(double share) : space(make_state_space(square_bounds())), simple(space) {
    ompl::msg::noOutputHandler();
    install_guided_sampler(*space, gap_sampler(share), kSeed);
    simple.setStateValidityChecker(
        [this](const ob::State* state) { return world.free_at(to_configuration(*state, 2)); });
    simple.getSpaceInformation()->setStateValidityCheckingResolution(0.01);
    ob::ScopedState<> start(space), goal(space);
    copy_to_state(kStart, *start.get());
    copy_to_state(kGoal, *goal.get());
    simple.setStartAndGoalStates(start, goal);
  }

  Eigen::MatrixXd solve(const ob::PlannerPtr& planner) {
    simple.setPlanner(planner);
    EXPECT_EQ(simple.solve(60.0), ob::PlannerStatus::EXACT_SOLUTION);
    return to_waypoints(simple.getSolutionPath().getStates(), 2);
  }

  WallWorld world;
  std::shared_ptr<ob::RealVectorStateSpace> space;
  og::SimpleSetup simple;
};

void expect_path(const WallProblem& setup, const Eigen::MatrixXd& path) {
  EXPECT_EQ(path.leftCols(1), kStart);
  EXPECT_EQ(path.rightCols(1), kGoal);
  EXPECT_TRUE(setup.world.path_is_free(path, 0.02));
}

TEST(StateSpace, KeepsConfigurationsAndBounds) {
  const auto space = make_state_space(square_bounds());
  EXPECT_EQ(space->getDimension(), 2u);
  EXPECT_EQ(space->getBounds().low, std::vector<double>(2, -1));
  EXPECT_EQ(space->getBounds().high, std::vector<double>(2, 1));
  ob::ScopedState<> state(space);
  copy_to_state(at(0.25, -0.75), *state.get());
  EXPECT_EQ(to_configuration(*state.get(), 2), at(0.25, -0.75));
  EXPECT_THROW(make_state_space(Eigen::Matrix2Xd::Zero(2, 2)), std::invalid_argument);
}

TEST(GuidedStateSampler, DrawsTheGuidedShare) {
  WallProblem setup(0.7);
  const ob::StateSamplerPtr sampler = setup.space->allocStateSampler();
  ob::ScopedState<> state(setup.space);
  constexpr int kSamples = 4000;
  int near = 0;
  for (int i = 0; i < kSamples; ++i) {
    sampler->sampleUniform(state.get());
    near += near_gap(to_configuration(*state.get(), 2));
  }
  EXPECT_NEAR(static_cast<double>(near) / kSamples, 0.7 + 0.3 * 0.15, 0.03);
}

TEST(GuidedStateSampler, SamplesNearAStateAreTheSpacesOwn) {
  WallProblem setup(1.0);
  const ob::StateSamplerPtr sampler = setup.space->allocStateSampler();
  ob::ScopedState<> state(setup.space), center(setup.space);
  copy_to_state(at(-0.5, -0.5), *center.get());
  for (int i = 0; i < 200; ++i) {
    sampler->sampleUniformNear(state.get(), center.get(), 0.1);
    EXPECT_LE((to_configuration(*state.get(), 2) - at(-0.5, -0.5)).cwiseAbs().maxCoeff(), 0.1);
    sampler->sampleGaussian(state.get(), center.get(), 0.01);
    EXPECT_LT((to_configuration(*state.get(), 2) - at(-0.5, -0.5)).norm(), 0.1);
  }
}

TEST(GuidedStateSampler, EverySamplerOfASpaceDrawsOtherSamples) {
  WallProblem setup(1.0);
  std::set<double> first;
  for (int i = 0; i < 10; ++i) {
    ob::ScopedState<> state(setup.space);
    setup.space->allocStateSampler()->sampleUniform(state.get());
    first.insert(to_configuration(*state.get(), 2)[0]);
  }
  EXPECT_EQ(first.size(), 10u);
}

/// Of the vertices of a solved planner other than start and goal.
double share_near_gap(const WallProblem& setup, const ob::Planner& planner) {
  ob::PlannerData data(setup.simple.getSpaceInformation());
  planner.getPlannerData(data);
  int near = 0, drawn = 0;
  for (unsigned int i = 0; i < data.numVertices(); ++i) {
    const Eigen::VectorXd q = to_configuration(*data.getVertex(i).getState(), 2);
    if (q == kStart || q == kGoal)
      continue;
    ++drawn;
    near += near_gap(q);
  }
  EXPECT_GT(drawn, 0);
  return static_cast<double>(near) / drawn;
}

constexpr double kUnlimited = 10;  // range: vertices are then the samples themselves

/// Where PRM expands its roadmap it goes from samples of the mixture towards others.
template <typename Planner>
void expect_guided(double least_share) {
  WallProblem setup(1.0);
  auto planner = std::make_shared<Planner>(setup.simple.getSpaceInformation());
  if constexpr (requires { planner->setRange(kUnlimited); })
    planner->setRange(kUnlimited);
  expect_path(setup, setup.solve(planner));
  EXPECT_GE(share_near_gap(setup, *planner), least_share) << planner->getName();
}

TEST(GuidedStateSampler, GuidesTreesAndRoadmaps) {
  expect_guided<og::RRT>(1);
  expect_guided<og::RRTConnect>(1);
  expect_guided<og::LazyPRM>(1);
  expect_guided<og::PRM>(0.9);
}

TEST(GuidedStateSampler, RefusesASpaceOfAnotherSize) {
  const auto space = make_state_space(Eigen::Matrix2Xd(square_bounds().leftCols(1)));
  EXPECT_THROW(install_guided_sampler(*space, gap_sampler(1), kSeed), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::ompl_planners::guided_state_sampler_test
