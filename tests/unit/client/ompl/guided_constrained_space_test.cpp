#include <gtest/gtest.h>
#include <ompl/base/ConstrainedSpaceInformation.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/constraint/AtlasStateSpace.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>
#include <ompl/base/spaces/constraint/TangentBundleStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include "client/ompl/guided_state_sampler.hpp"
#include "client/ompl/region_state_space.hpp"
#include "client/ompl/state_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/robots/planning/carrying_problem.hpp"

namespace kinship::ompl_planners::guided_constrained_space_test {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using planning::ConfigurationSampler;
using planning::RegionConstraint;
using planning::test_support::LineArm;

constexpr std::uint64_t kSeed = 29;
constexpr double kStep = 0.1;

Eigen::VectorXd configuration(const ob::State& state) {
  return *state.as<ob::ConstrainedStateSpace::StateType>();
}

/// Components of deviation `deviation` about every waypoint of a path.
Mixture along(const Eigen::MatrixXd& path, double deviation) {
  const Eigen::MatrixXd covariance =
      deviation * deviation * Eigen::MatrixXd::Identity(path.rows(), path.rows());
  return Mixture(Eigen::VectorXd::Constant(path.cols(), 1 / static_cast<double>(path.cols())), path,
                 std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(path.cols()), covariance));
}

TEST(RegionOmplConstraint, IsTheDistanceWithItsDerivativeAndOurProjection) {
  const LineArm arm;
  RegionConstraint region = arm.constraint();
  const RegionOmplConstraint constraint(2, region);
  Eigen::VectorXd q = LineArm::at_height(0.4) + Eigen::Vector2d(0.05, 0.1), distance(1);
  constraint.function(q, distance);
  EXPECT_EQ(distance[0], region.distance(q));
  Eigen::MatrixXd derivative(1, 2), numeric(1, 2);
  constraint.jacobian(q, derivative);
  constraint.ob::Constraint::jacobian(q, numeric);  // by differences
  EXPECT_LT((derivative - numeric).norm(), 1e-6);
  EXPECT_FALSE(constraint.isSatisfied(q));
  EXPECT_TRUE(constraint.project(q));
  EXPECT_EQ(region.projections(), 1u);
  EXPECT_TRUE(constraint.isSatisfied(q));
  EXPECT_TRUE(region.holds(q));
  constraint.jacobian(LineArm::at_height(0.4), derivative);
  EXPECT_TRUE(derivative.allFinite());
  EXPECT_THROW(RegionOmplConstraint(1, region), std::invalid_argument);
}

/// The arm on the line, in a constrained space of OMPL.
struct LineSpaces {
  LineArm arm;
  RegionConstraint region = arm.constraint();
  ob::StateSpacePtr ambient = make_state_space(arm.bounds);
  ob::ConstraintPtr constraint = std::make_shared<RegionOmplConstraint>(2, region);

  std::shared_ptr<const ConfigurationSampler> sampler(double height) const {
    return std::make_shared<ConfigurationSampler>(arm.bounds, arm.chain,
                                                  along(LineArm::at_height(height), 0.02), 1.0);
  }
};

TEST(GuidedConstrainedSpace, DrawsFromTheMixtureAndProjects) {
  LineSpaces line;
  const auto space = std::make_shared<ob::ProjectedStateSpace>(line.ambient, line.constraint);
  const ob::ConstrainedSpaceInformation information(space);
  install_guided_sampler(*space, line.sampler(0.7), kSeed);
  const ob::StateSamplerPtr sampler = space->allocStateSampler();
  ob::ScopedState<> state(space);
  for (int i = 0; i < 200; ++i) {
    sampler->sampleUniform(state.get());
    const Eigen::VectorXd q = configuration(*state.get());
    EXPECT_LT((q - LineArm::at_height(0.7)).norm(), 0.2);
    EXPECT_TRUE(line.region.holds(q));
  }
}

template <typename Space>
void expect_refused(const std::string& prefix) {
  LineSpaces line;
  Space space(line.ambient, line.constraint);
  try {
    install_guided_sampler(space, line.sampler(0), kSeed);
    FAIL() << prefix << " accepted";
  } catch (const std::invalid_argument& refusal) {
    const std::string message = refusal.what();
    EXPECT_NE(message.find("'" + space.getName() + "'"), std::string::npos) << message;
    EXPECT_EQ(space.getName().substr(0, prefix.size()), prefix);
    EXPECT_NE(message.find("use a ProjectedStateSpace"), std::string::npos) << message;
  }
}

TEST(GuidedConstrainedSpace, RefusesSpacesThatWouldIgnoreTheSampler) {
  expect_refused<ob::AtlasStateSpace>("Atlas");
  expect_refused<ob::TangentBundleStateSpace>("TangentBundle");
  LineSpaces line;
  ob::SO2StateSpace circle;
  EXPECT_THROW(install_guided_sampler(circle, line.sampler(0), kSeed), std::invalid_argument);
  const auto odd = std::make_shared<ob::SO2StateSpace>();
  ob::ProjectedStateSpace over_circle(odd, line.constraint);
  EXPECT_THROW(install_guided_sampler(over_circle, line.sampler(0), kSeed), std::invalid_argument);
}

/// An arm of three links whose tip keeps to a line; where the tip crosses the middle of the line,
/// the last joint has to pass a narrow gap.
struct GatedArm {
  GatedArm() {
    bounds.resize(2, 3);
    bounds << Eigen::RowVector3d::Constant(-2), Eigen::RowVector3d::Constant(2);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    line.T_task_region.translation().x() = 1.5;
    line.bounds.col(1) << -kInfinity, kInfinity;
    line.bounds.col(5) << -kInfinity, kInfinity;
  }
  RegionConstraint region() const { return {chain, line, Eigen::Isometry3d::Identity(), bounds}; }
  Eigen::VectorXd on_line(double q1, double q2, double q3) const {
    Eigen::VectorXd q = Eigen::Vector3d(q1, q2, q3);
    EXPECT_TRUE(region().project(q));
    return q;
  }
  double height(const Eigen::VectorXd& q) const {
    return kinematics::T_base_tip(chain, q).translation().y();
  }
  bool is_free(const Eigen::VectorXd& q) const {
    return std::abs(height(q)) > 0.1 || (q[2] > 1.2 && q[2] < 1.35);
  }

  kinematics::Chain chain = test::PlanarArm{.lengths_m = {0.8, 0.8, 0.8}, .limit = 2}.chain();
  Eigen::Matrix2Xd bounds;
  TaskSpaceRegion line;
};

constexpr std::uint64_t kMaxChecks = 1000;

/// RRTConnect on the projected space. \return collision checks, kMaxChecks if unsolved.
std::uint64_t plan_on_projected_space(const GatedArm& arm, const ConfigurationSampler& guidance,
                                      std::uint64_t seed) {
  ompl::msg::noOutputHandler();
  RegionConstraint region = arm.region();
  const auto space = std::make_shared<ob::ProjectedStateSpace>(
      make_state_space(arm.bounds), std::make_shared<RegionOmplConstraint>(3, region));
  space->setDelta(kStep);
  const auto information = std::make_shared<ob::ConstrainedSpaceInformation>(space);
  install_guided_sampler(*space, std::make_shared<ConfigurationSampler>(guidance), seed);
  og::SimpleSetup setup(information);
  std::uint64_t asked = 0;
  setup.setStateValidityChecker([&](const ob::State* state) {
    ++asked;
    return arm.is_free(configuration(*state));
  });
  ob::ScopedState<> start(space), goal(space);
  start->as<ob::ConstrainedStateSpace::StateType>()->copy(arm.on_line(-1.3, 0.7, 0.7));
  goal->as<ob::ConstrainedStateSpace::StateType>()->copy(arm.on_line(0.2, 0.7, 0.7));
  setup.setStartAndGoalStates(start, goal);
  setup.setPlanner(std::make_shared<og::RRTConnect>(information));
  const auto enough = [&] { return asked >= kMaxChecks; };
  if (setup.solve(ob::PlannerTerminationCondition(enough)) != ob::PlannerStatus::EXACT_SOLUTION)
    return kMaxChecks;
  for (const ob::State* state : setup.getSolutionPath().getStates())
    EXPECT_TRUE(region.holds(configuration(*state)));
  return asked;
}

TEST(GuidedConstrainedSpace, GuidesRrtConnectOnAProjectedSpace) {
  const GatedArm arm;
  ASSERT_LT(arm.height(arm.on_line(-1.3, 0.7, 0.7)), -0.3);
  ASSERT_GT(arm.height(arm.on_line(0.2, 0.7, 0.7)), 0.3);
  const Eigen::VectorXd gate = arm.on_line(-1.044, 0.981, 1.25);
  ASSERT_TRUE(arm.is_free(gate) && std::abs(arm.height(gate)) < 0.1);
  const ConfigurationSampler uniform(arm.bounds);
  const ConfigurationSampler guided(arm.bounds, arm.chain, along(gate, 0.1), 0.9);
  std::uint64_t uniform_checks = 0, guided_checks = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    uniform_checks += plan_on_projected_space(arm, uniform, seed);
    guided_checks += plan_on_projected_space(arm, guided, seed);
  }
  EXPECT_LT(2 * guided_checks, uniform_checks);
}

}  // namespace
}  // namespace kinship::ompl_planners::guided_constrained_space_test
