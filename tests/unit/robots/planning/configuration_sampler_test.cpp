#include "robots/planning/configuration_sampler.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robots/planning/planning_bounds.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::configuration_sampler_test {
namespace {

using test_support::at;
using test_support::square_bounds;

constexpr std::uint64_t kSeed = 17;
constexpr int kSamples = 4000;

kinematics::Chain arm(double limit) {
  test::PlanarArm arm;
  arm.lengths_m = {0.4, 0.3};
  arm.limit = limit;
  return arm.chain();
}

Mixture bump(const Eigen::VectorXd& mean, double deviation) {
  return Mixture(Eigen::VectorXd::Ones(1), mean,
                 {Eigen::MatrixXd::Identity(2, 2) * deviation * deviation});
}

bool within(const Eigen::Matrix2Xd& bounds, const Eigen::VectorXd& q) {
  return (q.transpose().array() >= bounds.row(0).array()).all() &&
         (q.transpose().array() <= bounds.row(1).array()).all();
}

/// Share of samples within a small square about a point that a bump fills.
double share_near(const ConfigurationSampler& sampler, const Eigen::VectorXd& center) {
  std::mt19937_64 generator(kSeed);
  int near = 0;
  for (int i = 0; i < kSamples; ++i)
    near += (sampler.sample(generator) - center).cwiseAbs().maxCoeff() < 0.05;
  return static_cast<double>(near) / kSamples;
}

TEST(ConfigurationSampler, UniformSamplesFillTheBoundsEvenly) {
  const ConfigurationSampler sampler(square_bounds());
  std::mt19937_64 generator(kSeed);
  Eigen::Matrix2d quadrants = Eigen::Matrix2d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::VectorXd q = sampler.sample(generator);
    ASSERT_TRUE(within(sampler.bounds(), q));
    quadrants(q[0] > 0, q[1] > 0) += 1;
  }
  // Four standard deviations of a count with p = 1/4.
  EXPECT_LT((quadrants.array() - kSamples / 4.0).abs().maxCoeff(),
            4 * std::sqrt(kSamples * 3.0 / 16));
}

TEST(ConfigurationSampler, TheShareOfSamplesIsGuided) {
  const Eigen::VectorXd center = at(0.5, -0.5);
  for (const double share : {0.0, 0.3, 0.9, 1.0}) {
    const ConfigurationSampler sampler(square_bounds(), arm(1), bump(center, 0.01), share);
    EXPECT_NEAR(share_near(sampler, center), share + (1 - share) * 0.0025, 0.03) << share;
  }
}

TEST(ConfigurationSampler, GuidedSamplesStayWithinTheBounds) {
  const ConfigurationSampler sampler(square_bounds(), arm(1), bump(at(0.9, 0.9), 0.5), 1.0);
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < kSamples; ++i)
    ASSERT_TRUE(within(sampler.bounds(), sampler.sample(generator)));
}

TEST(ConfigurationSampler, GuidedSamplesOfWideJointsAreTurnedToTheStart) {
  const auto chain = arm(2 * M_PI);
  const Eigen::VectorXd start = at(5, -5);  // the bump lies a turn away in both joints
  const Eigen::VectorXd center = at(5.5 - 2 * M_PI, 2 * M_PI - 5.5);
  const ConfigurationSampler sampler(planning_bounds(chain, start), chain, bump(center, 0.01), 1.0);
  EXPECT_GT(share_near(sampler, at(5.5, -5.5)), 0.999);
}

TEST(ConfigurationSampler, AWideJointIsTruncatedWhereItsBoundsAreClipped) {
  const auto chain = arm(2 * M_PI);
  // The first joint may go from pi to 2 pi; a bump at pi (and -pi) lies half inside.
  const Eigen::Matrix2Xd bounds = planning_bounds(chain, at(2 * M_PI, 0));
  const ConfigurationSampler sampler(bounds, chain, bump(at(-M_PI, 0), 0.2), 1.0);
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::VectorXd q = sampler.sample(generator);
    ASSERT_TRUE(within(bounds, q));
    ASSERT_LT(q[0], M_PI + 1.2);
  }
}

TEST(ConfigurationSampler, IsUniformWhereTheMixtureLiesOutsideTheBounds) {
  const ConfigurationSampler sampler(square_bounds(), arm(1), bump(at(30, 30), 0.1), 1.0);
  std::mt19937_64 generator(kSeed);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int i = 0; i < 200; ++i)
    mean += sampler.sample(generator) / 200;
  EXPECT_LT(mean.norm(), 0.25);
}

TEST(ConfigurationSampler, EqualSeedEqualSamples) {
  const ConfigurationSampler sampler(square_bounds(), arm(1), bump(at(0, 0), 0.3), 0.5);
  std::mt19937_64 one(kSeed), two(kSeed);
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(sampler.sample(one), sampler.sample(two));
}

TEST(ConfigurationSampler, RefusesWhatDoesNotFit) {
  const auto chain = arm(1);
  const Mixture mixture = bump(at(0, 0), 0.1);
  EXPECT_THROW(ConfigurationSampler(square_bounds(), chain, mixture, 1.1), std::invalid_argument);
  EXPECT_THROW(ConfigurationSampler(square_bounds(), chain, mixture, NAN), std::invalid_argument);
  EXPECT_THROW(ConfigurationSampler(Eigen::Matrix2Xd::Zero(2, 3), chain, mixture, 0.5),
               std::invalid_argument);
  Eigen::Matrix2Xd crossed = -square_bounds();
  EXPECT_THROW(ConfigurationSampler{crossed}, std::invalid_argument);
}

}  // namespace
}  // namespace kinship::planning::configuration_sampler_test
