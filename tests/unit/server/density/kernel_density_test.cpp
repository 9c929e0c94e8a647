#include "server/density/kernel_density.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "proto/types/limits.hpp"
#include "server/density/hold_out.hpp"

namespace kinship::density::kernel_density_test {
namespace {

constexpr std::uint64_t kSeed = 41;

Eigen::MatrixXd normal_points(Eigen::Index dimension, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(dimension, count, [&] { return normal(generator); });
}

/// Paths of `length` configurations each, one after the other.
KernelDensityOptions options_for(const Eigen::MatrixXd& points, Eigen::Index length = 10) {
  KernelDensityOptions options;
  options.floors_of_joints = Eigen::VectorXd::Constant(points.rows(), 1e-4);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    options.path_of_configuration.push_back(static_cast<std::uint32_t>(i / length));
  return options;
}

KernelDensity estimate(const Eigen::MatrixXd& points, const KernelDensityOptions& options) {
  return estimate_kernel_density(points, Eigen::VectorXd::Ones(points.cols()), options)
      .value_or_throw();
}

Eigen::Index kernel_at(const Mixture& mixture, const Eigen::VectorXd& q) {
  Eigen::Index nearest = 0;
  (mixture.means().colwise() - q).colwise().norm().minCoeff(&nearest);
  return nearest;
}

TEST(KernelDensity, IntegratesToOne) {
  const Eigen::MatrixXd points = normal_points(2, 60);
  const Mixture mixture = estimate(points, options_for(points)).mixture;
  EXPECT_EQ(mixture.size(), 60);
  EXPECT_TRUE(mixture.shares_covariance());
  constexpr Eigen::Index kCells = 300;
  const double step = 16.0 / static_cast<double>(kCells);
  Eigen::MatrixXd row(2, kCells);
  double sum = 0;
  for (Eigen::Index i = 0; i < kCells; ++i) {
    row.row(0).setConstant(-8 + static_cast<double>(i) * step);
    row.row(1).setLinSpaced(-8, 8 - step);
    sum += kinship::mixture::log_density(mixture, row).array().exp().sum() * step * step;
  }
  EXPECT_NEAR(sum, 1, 1e-6);
}

/// Independent points of the normal distribution around either of two places.
Eigen::MatrixXd draws_around(double distance, Eigen::Index count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd draws = Eigen::MatrixXd::NullaryExpr(2, count, [&] { return normal(generator); });
  for (Eigen::Index i = 0; i < count; i += 2)
    draws(0, i) += distance;
  return draws;
}

/// How much less log density a mixture has than the true one, which stands at the two places, mean
/// over others of its draws: the Kullback-Leibler divergence but for the choice of those.
double loss_of(const Mixture& mixture, double distance) {
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(2, 2);
  means(0, 1) = distance;
  const Mixture truth(Eigen::Vector2d(0.5, 0.5), means, {Eigen::Matrix2d::Identity()});
  const Eigen::MatrixXd others = draws_around(distance, 300, kSeed + 100);
  return (kinship::mixture::log_density(truth, others) -
          kinship::mixture::log_density(mixture, others))
      .mean();
}

/// The least loss of kernels at these points whose covariance is a multiple of the points' own.
double least_loss(const Eigen::MatrixXd& points) {
  const auto count = static_cast<double>(points.cols());
  const Eigen::MatrixXd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix2d covariance = centred * centred.transpose() / count;
  double least = std::numeric_limits<double>::infinity();
  for (const double scale : {1.0, 0.7, 0.5, 0.35, 0.25})
    least = std::min(least, loss_of({Eigen::VectorXd::Constant(points.cols(), 1 / count),
                                     points,
                                     {scale * scale * covariance}},
                                    0));
  return least;
}

TEST(KernelDensity, RecoversADensityAboutAsWellAsKernelsCan) {
  // In two dimensions the loss of the best bandwidth falls about as count^(-2/3).
  constexpr int kDraws = 4;
  double few = 0, many = 0, least_of_many = 0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const Eigen::MatrixXd points = draws_around(0, 500, kSeed + draw);
    const Eigen::MatrixXd start = points.leftCols(50);
    few += loss_of(estimate(start, options_for(start, 1)).mixture, 0) / kDraws;
    many += loss_of(estimate(points, options_for(points, 1)).mixture, 0) / kDraws;
    least_of_many += least_loss(points) / kDraws;
  }
  EXPECT_LT(many, 0.4 * few);
  EXPECT_LT(many, 1.5 * least_of_many + 0.005);
  EXPECT_LT(many, 0.06);
}

TEST(KernelDensity, PlacesFarFromEachOtherDoNotWidenTheKernels) {
  constexpr double kDistance = 40;
  const Eigen::MatrixXd points = draws_around(kDistance, 500, kSeed);
  const KernelDensity made = estimate(points, options_for(points, 1));
  EXPECT_GT(made.bandwidth.clusters, 1);
  EXPECT_LT(loss_of(made.mixture, kDistance), 0.12);
}

TEST(KernelDensity, WeighsItsKernelsAsTheConfigurations) {
  const Eigen::MatrixXd points = normal_points(3, 40);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(40);
  weights[7] = 5;
  weights[8] = 0;
  const Mixture mixture =
      estimate_kernel_density(points, weights, options_for(points)).value_or_throw().mixture;
  EXPECT_EQ(mixture.size(), 39);
  const double one = mixture.weights()[kernel_at(mixture, points.col(3))];
  EXPECT_NEAR(mixture.weights()[kernel_at(mixture, points.col(7))], 5 * one, 1e-12);
  EXPECT_NEAR(mixture.weights().sum(), 1, 1e-12);
}

TEST(KernelDensity, ManyConfigurationsAreSampledByWeight) {
  const Eigen::MatrixXd points = normal_points(3, 9000);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(9000);
  weights[4321] = 900;                                             // a tenth of all but itself
  const KernelDensityOptions options = options_for(points, 9000);  // one path: nothing to score
  const Mixture mixture =
      estimate_kernel_density(points, weights, options).value_or_throw().mixture;
  EXPECT_LE(mixture.size(), static_cast<Eigen::Index>(kMaxKernels));
  EXPECT_GT(mixture.size(), 3000);
  EXPECT_NEAR(mixture.weights()[kernel_at(mixture, points.col(4321))], 900.0 / 9899, 1e-3);
  const Eigen::Vector3d mean = points * weights / weights.sum();
  EXPECT_LT((mixture.means() * mixture.weights() - mean).norm(), 0.02);

  KernelDensityOptions other_seed = options;
  other_seed.seed = 1;
  EXPECT_EQ(estimate_kernel_density(points, weights, options)->mixture.means(), mixture.means());
  EXPECT_NE(estimate_kernel_density(points, weights, other_seed)->mixture.means(), mixture.means());
}

TEST(KernelDensity, WithAPathTheBandwidthIsARuleAndWithTwoItIsMeasured) {
  const Eigen::MatrixXd points = normal_points(2, 40);
  const KernelDensity one = estimate(points, options_for(points, 40));
  EXPECT_EQ(one.bandwidth, (Bandwidth{1, scale_of_one_path(2)}));
  EXPECT_FALSE(one.held_out_score);
  // two paths that are one and the same: nothing is as good as narrow kernels
  Eigen::MatrixXd twice(2, 80);
  twice << points, points + 1e-3 * normal_points(2, 40);
  const KernelDensity two = estimate(twice, options_for(twice, 40));
  EXPECT_LT(two.bandwidth.scale, 0.2);
  EXPECT_FALSE(two.held_out_score);
  // two paths far from each other: wide ones
  twice << points, points.colwise() + Eigen::Vector2d(6, 0);
  EXPECT_GT(estimate(twice, options_for(twice, 40)).bandwidth.scale, 0.4);
}

TEST(KernelDensity, WithFewPathsTheBandwidthIsNotTheLuckOfOneFifth) {
  // One fifth of 20 paths loses 0.25 more than each in turn, and up to 3.8 in a draw.
  constexpr int kDraws = 16;
  double mean = 0, worst = 0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const Eigen::MatrixXd points = draws_around(0, 20, kSeed + 10 * draw);
    const double loss = loss_of(estimate(points, options_for(points, 1)).mixture, 0);
    mean += loss / kDraws;
    worst = std::max(worst, loss);
  }
  EXPECT_LT(mean, 0.4);
  EXPECT_LT(worst, 1.2);
}

TEST(KernelDensity, ItsScoreIsThatOfTheFifthThatAnExportMarks) {
  const Eigen::MatrixXd points = normal_points(2, 200);
  const KernelDensityOptions options = options_for(points, 10);
  const KernelDensity all = estimate(points, options);
  const std::vector<std::uint8_t> held_out = held_out_paths(20, options.seed);
  Eigen::MatrixXd others(2, 160), scored(2, 40);
  for (Eigen::Index i = 0, other = 0, mine = 0; i < 200; ++i)
    if (held_out[static_cast<std::size_t>(i / 10)] != 0)
      scored.col(mine++) = points.col(i);
    else
      others.col(other++) = points.col(i);
  // Its kernels, were they at the other paths' configurations, with a covariance like theirs.
  const Mixture mixture(Eigen::VectorXd::Constant(160, 1.0 / 160), others,
                        {all.mixture.covariance(0)});
  const double log_uniform =
      -(points.rowwise().maxCoeff() - points.rowwise().minCoeff()).array().log().sum();
  const double score = (0.99 * kinship::mixture::log_density(mixture, scored).array().exp() +
                        0.01 * std::exp(log_uniform))
                           .log()
                           .mean();
  EXPECT_NEAR(*all.held_out_score, score, 0.1);
}

TEST(KernelDensity, HasAScoreFromTenPathsOn) {
  const Eigen::MatrixXd points = normal_points(2, 100);
  EXPECT_TRUE(estimate(points, options_for(points, 10)).held_out_score);
  EXPECT_FALSE(estimate(points, options_for(points, 12)).held_out_score);
}

TEST(KernelDensity, CentresStayWithinLimitsAsF32) {
  constexpr double kLower = -1.0000000001;  // between two f32, as is the upper one
  constexpr double kUpper = 2.0943951023931953;
  Eigen::MatrixXd points = normal_points(2, 50);
  points = points.cwiseMax(kLower).cwiseMin(kUpper);
  points(0, 0) = points(1, 1) = kUpper;
  points(0, 2) = points(1, 3) = kLower;
  ASSERT_GT(static_cast<double>(static_cast<float>(kUpper)), kUpper);
  KernelDensityOptions options = options_for(points);
  options.limits.resize(2, 2);
  options.limits << kLower, kLower, kUpper, kUpper;
  const Eigen::MatrixXd centres = estimate(points, options).mixture.means();
  EXPECT_EQ(centres.cast<float>().cast<double>(), centres);
  EXPECT_GE(centres.minCoeff(), kLower);
  EXPECT_LE(centres.maxCoeff(), kUpper);
  EXPECT_GT(centres.maxCoeff(), kUpper - 1e-6);
}

TEST(KernelDensity, CentresOutsideLimitsOrBetweenThoseWithoutAFloatAreOnlyRounded) {
  Eigen::MatrixXd points = normal_points(2, 50);
  points.row(1).setConstant(0.7);
  KernelDensityOptions options = options_for(points);
  options.limits.resize(2, 2);
  options.limits << -0.1, 0.7, 0.1, 0.7;
  const Eigen::MatrixXd centres = estimate(points, options).mixture.means();
  EXPECT_EQ(centres.row(1), Eigen::RowVectorXd::Constant(50, 0.7F));
  int outside = 0;
  for (const double value : centres.row(0)) {
    outside += std::abs(value) > 0.1 ? 1 : 0;
    const auto nearest = [&](double x) {
      return static_cast<double>(static_cast<float>(x)) == value;
    };
    EXPECT_TRUE(std::any_of(points.row(0).begin(), points.row(0).end(), nearest)) << value;
  }
  EXPECT_GT(outside, 30);
}

TEST(KernelDensity, ConstantJointGetsTheFloor) {
  Eigen::MatrixXd points = normal_points(3, 50);
  points.row(1).setConstant(0.75);
  const Mixture mixture = estimate(points, options_for(points)).mixture;
  EXPECT_NEAR(mixture.covariance(0)(1, 1), 1e-4, 1e-12);
  EXPECT_TRUE((mixture.means().row(1).array() == 0.75).all());
}

TEST(KernelDensity, OnePointFarAwayIsOneKernel) {
  Eigen::MatrixXd points = normal_points(2, 400);
  const Eigen::VectorXd near =
      kinship::mixture::log_density(estimate(points, options_for(points)).mixture, points);
  points.col(399).setConstant(1000);
  const Mixture mixture = estimate(points, options_for(points)).mixture;
  EXPECT_EQ(mixture.size(), 400);
  EXPECT_NEAR(mixture.means().maxCoeff(), 1000, 1e-3);
  const Eigen::VectorXd with = kinship::mixture::log_density(mixture, points);
  EXPECT_TRUE(with.allFinite());
  EXPECT_GT(with.head(300).mean(), near.head(300).mean() - 1);
}

TEST(KernelDensity, RefusesWhatNoMixtureIsMadeOfEither) {
  const auto refusal = [](const Eigen::MatrixXd& points, double floor) {
    KernelDensityOptions options = options_for(points);
    options.floors_of_joints.setConstant(floor);
    const auto made =
        estimate_kernel_density(points, Eigen::VectorXd::Ones(points.cols()), options);
    return made ? "accepted" : made.error().message;
  };
  EXPECT_EQ(refusal(Eigen::MatrixXd::Constant(3, 1, 0.5), 1e-4),
            "kernels: 1 distinct configurations, need at least 4 for 3 joints");
  EXPECT_EQ(refusal(Eigen::MatrixXd::Constant(3, 500, 0.5), 1e-4),
            "kernels: 1 distinct configurations, need at least 4 for 3 joints");
  Eigen::MatrixXd points = normal_points(3, 20);
  points.row(2).setZero();
  EXPECT_EQ(refusal(points, 0),
            "kernels: mixture: covariance of component 0 is not positive definite; "
            "covariance_floor 0 is too small for this data");
  {
    KernelDensityOptions one_path = options_for(points, 20);  // no other path that would show it
    one_path.floors_of_joints.setZero();
    EXPECT_FALSE(estimate_kernel_density(points, Eigen::VectorXd::Ones(20), one_path));
  }
  points(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(points, 1e-4).find("configuration 5 is not finite"), std::string::npos);
  EXPECT_THROW(
      static_cast<void>(estimate_kernel_density(normal_points(3, 20), Eigen::VectorXd::Ones(19),
                                                options_for(normal_points(3, 20)))),
      std::invalid_argument);
  KernelDensityOptions gap = options_for(normal_points(3, 20));
  gap.path_of_configuration.back() = 20;
  EXPECT_THROW(static_cast<void>(
                   estimate_kernel_density(normal_points(3, 20), Eigen::VectorXd::Ones(20), gap)),
               std::invalid_argument);
}

}  // namespace
}  // namespace kinship::density::kernel_density_test
