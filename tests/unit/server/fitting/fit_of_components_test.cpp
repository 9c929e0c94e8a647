// How a fit gets its number of components, and what it does with joints that turn without end.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "tests/unit/server/fitting/fit_fixture.hpp"

namespace kinship::fitting::fit_of_components_test {
namespace {

using FitOfComponents = FitDistribution;

TEST_F(FitOfComponents, ComponentsAreChosenIfAsked) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  DistributionKey key = quick_key_of(pupil_);
  key.profile.density.components = 0;
  const Distribution chosen = fitted(key);
  ASSERT_TRUE(chosen.mixture) << chosen.reason;
  ASSERT_FALSE(chosen.component_scores.empty());
  ASSERT_TRUE(chosen.held_out_score);
  double best = -std::numeric_limits<double>::infinity();
  for (const ComponentScore& score : chosen.component_scores)
    best = std::max(best, score.score);
  EXPECT_EQ(*chosen.held_out_score, best);

  context_.fit_threads = 3;
  EXPECT_EQ(fitted(key).mixture->means(), chosen.mixture->means());
  key.profile.density.components = 2;
  EXPECT_TRUE(fitted(key).component_scores.empty());
  EXPECT_TRUE(fitted(key).held_out_score);  // of the prior
  key.profile.density.prior = 0;
  EXPECT_FALSE(fitted(key).held_out_score);
}

TEST_F(FitOfComponents, BelowTenPathsComponentsAreNotScored) {
  report(fleet::solved(teacher_, "shelf", 9, 1));
  DistributionKey key = quick_key_of(pupil_);
  key.profile.density.components = 0;
  const Distribution distribution = fitted(key);
  ASSERT_TRUE(distribution.mixture) << distribution.reason;
  EXPECT_LE(distribution.mixture->size(), 2);
  EXPECT_TRUE(distribution.component_scores.empty());
}

TEST_F(FitOfComponents, KernelsStandAtTheConfigurations) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  DistributionKey key = quick_key_of(pupil_);
  const Mixture mixture = fitted(key).mixture.value();
  key.profile.density.estimator = Estimator::Kernels;
  const Distribution kernels = fitted(key);
  ASSERT_TRUE(kernels.mixture) << kernels.reason;
  EXPECT_TRUE(kernels.mixture->shares_covariance());
  EXPECT_GT(kernels.mixture->size(), mixture.size());
  EXPECT_LE(kernels.mixture->size(), static_cast<Eigen::Index>(kernels.configurations));
  EXPECT_TRUE(kernels.held_out_score);
  EXPECT_TRUE(kernels.component_scores.empty());
  const Eigen::MatrixXd& centres = kernels.mixture->means();
  EXPECT_EQ(centres.cast<float>().cast<double>(), centres);
  const Eigen::VectorXd lower = kernels.limits.row(0).transpose();
  const Eigen::VectorXd upper = kernels.limits.row(1).transpose();
  EXPECT_GE((centres.colwise() - lower).minCoeff(), 0);
  EXPECT_LE((centres.colwise() - upper).maxCoeff(), 0);
  const Eigen::VectorXd mean = mixture.means() * mixture.weights();
  EXPECT_LT((centres * kernels.mixture->weights() - mean).norm(), 1e-5);

  context_.fit_threads = 3;
  EXPECT_EQ(fitted(key).mixture->means(), centres);
}

TEST_F(FitOfComponents, AContinuousJointIsCutBesideItsAngles) {
  RobotDescription turner = fleet::teacher();
  turner.label = "turner";
  const std::string limited = "type='revolute'", turning = "type='continuous'";
  turner.urdf.replace(turner.urdf.find(limited), limited.size(), turning);
  registry_.register_robot(turner, 2);
  const runtime::Robot robot = fleet::robot_of(turner);
  // A sweep of the first joint through pi.
  std::vector<Attempt> attempts = fleet::solved(robot, "shelf", 10, 1);
  for (Attempt& attempt : attempts) {
    Eigen::MatrixXd waypoints = attempt.path->waypoints();
    waypoints.row(0).setLinSpaced(2.6, 3.8);
    attempt.path = Path(waypoints);
  }
  report(attempts);
  const Distribution distribution = fitted(quick_key_of(robot));
  ASSERT_TRUE(distribution.mixture) << distribution.reason;
  ASSERT_EQ(distribution.cuts.size(), 3U);
  ASSERT_TRUE(distribution.cuts[0]);
  EXPECT_FALSE(distribution.cuts[1]);
  const double cut = *distribution.cuts[0];
  EXPECT_NEAR(cut, 0.06, 0.3);
  EXPECT_EQ(distribution.limits(0, 0), cut);
  EXPECT_NEAR(distribution.limits(1, 0) - cut, 2 * std::numbers::pi, 1e-12);
  const Eigen::RowVectorXd means = distribution.mixture->means().row(0);
  EXPECT_GT(means.minCoeff(), 2.5);
  EXPECT_LT(means.maxCoeff(), 3.9);
}

}  // namespace
}  // namespace kinship::fitting::fit_of_components_test
