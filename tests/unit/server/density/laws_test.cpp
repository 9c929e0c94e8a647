// What holds of every way from configurations to a mixture, on ordinary and on nasty data.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "proto/mixture/sampler.hpp"
#include "tests/unit/server/density/estimators.hpp"

namespace kinship::density::laws_test {
namespace {

using test::Sample;
using test::Way;

constexpr std::uint64_t kSeed = 43;
constexpr Eigen::Index kJoints = 3;
constexpr Eigen::Index kPoints = 240;

/// Three clouds; every number a multiple of 2^-12, so that whole numbers can be added without a
/// rounding, also as f32.
Eigen::MatrixXd clouds(Eigen::Index count, std::uint64_t seed = kSeed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd points(kJoints, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index joint = 0; joint < kJoints; ++joint)
      points(joint, i) =
          std::round(4096 * (0.3 * normal(generator) + static_cast<double>((i + joint) % 3))) /
          4096;
  return points;
}

Sample with_weights(double ratio) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(kPoints);
  for (Eigen::Index i = 0; i < kPoints; i += 7)
    weights[i] = ratio;
  return test::sample_of("weights " + std::to_string(ratio) + " to one", clouds(kPoints), weights);
}

std::vector<Sample> make_samples() {
  std::vector<Sample> samples;
  const Eigen::MatrixXd points = clouds(kPoints);
  samples.push_back(test::sample_of("random", points));
  Eigen::MatrixXd nasty = points;
  nasty.row(1) = 2 * points.row(0);
  nasty.row(2) = -points.row(0);
  samples.push_back(test::sample_of("collinear", nasty));
  nasty = points;
  nasty.row(1).setConstant(0.75);
  samples.push_back(test::sample_of("constant joint", nasty));
  samples.push_back(test::sample_of("fewer points than components may have", clouds(24)));
  nasty = points;
  nasty.col(100).setConstant(8192);
  samples.push_back(test::sample_of("one point far away", nasty));
  samples.push_back(test::sample_of("values of 1e6", (262144 * points.array()).matrix()));
  nasty = points;
  nasty.rightCols(120) = points.col(0).replicate(1, 120);
  samples.push_back(test::sample_of("half of the points equal", nasty));
  samples.push_back(with_weights(1e9));
  samples.push_back(with_weights(1e-9));
  for (Sample& sample : samples)
    sample = test::with_fit_before(std::move(sample));
  return samples;
}

const std::vector<Sample>& samples() {
  static const std::vector<Sample> made = make_samples();
  return made;
}

double scale_of(const Sample& sample) { return 1 + sample.points.cwiseAbs().maxCoeff(); }

Mixture estimate(Way way, const Sample& sample, const Computation& computation = {}) {
  return test::try_estimate(way, sample, computation).value_or_throw();
}

std::vector<Eigen::Index> columns_of(const Sample& sample) {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(sample.points.cols()));
  std::iota(columns.begin(), columns.end(), Eigen::Index{0});
  return columns;
}

/// Up to the rounding of sums of squares of numbers as large as the sample's.
void expect_near(const Mixture& a, const Mixture& b, double scale) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT((a.weights() - b.weights()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((a.means() - b.means()).cwiseAbs().maxCoeff(), 1e-9 * scale);
  ASSERT_EQ(a.covariances().size(), b.covariances().size());
  for (std::size_t k = 0; k < a.covariances().size(); ++k)
    EXPECT_LT((a.covariances()[k] - b.covariances()[k]).cwiseAbs().maxCoeff(),
              1e-9 + 1e-11 * scale * scale);
}

class Laws : public testing::TestWithParam<Way> {
 protected:
  template <typename Check>
  static void for_each_sample(const Check& check) {
    for (const Sample& sample : samples()) {
      SCOPED_TRACE(sample.name);
      ASSERT_TRUE(sample.before || GetParam() != Way::WarmStart);
      check(sample);
    }
  }
};

TEST_P(Laws, WeightsSumToOneAndEigenvaluesKeepTheFloor) {
  for_each_sample([](const Sample& sample) {
    const Mixture mixture = estimate(GetParam(), sample);
    EXPECT_NEAR(mixture.weights().sum(), 1, 1e-12);
    for (const Eigen::MatrixXd& covariance : mixture.covariances())
      EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues()[0],
                test::kFloor * (1 - 1e-9) - 1e-14 * scale_of(sample) * scale_of(sample));
    EXPECT_TRUE(kinship::mixture::log_density(mixture, sample.points).allFinite());
  });
}

TEST_P(Laws, SameBytesForAnyNumberOfThreads) {
  for_each_sample([](const Sample& sample) {
    const Mixture one = estimate(GetParam(), sample);
    for (const int threads : {2, 5}) {
      const Mixture several = estimate(GetParam(), sample, {.threads = threads});
      EXPECT_EQ(several.weights(), one.weights());
      EXPECT_EQ(several.means(), one.means());
      EXPECT_EQ(several.covariances(), one.covariances());
    }
  });
}

TEST_P(Laws, PrunedEqualsDense) {
  for_each_sample([](const Sample& sample) {
    expect_near(estimate(GetParam(), sample, {.prune = true}),
                estimate(GetParam(), sample, {.prune = false}), scale_of(sample));
  });
}

TEST_P(Laws, OrderOfTheConfigurationsDoesNotMatter) {
  for_each_sample([](const Sample& sample) {
    std::vector<Eigen::Index> columns = columns_of(sample);
    std::mt19937_64 generator(kSeed);
    std::shuffle(columns.begin(), columns.end(), generator);
    expect_near(estimate(GetParam(), sample), estimate(GetParam(), sample.with_columns(columns)),
                scale_of(sample));
  });
}

TEST_P(Laws, TranslationMovesTheMeansOnly) {
  const Eigen::Vector3d offset(16, -8, 4);
  for_each_sample([&offset](const Sample& sample) {
    Sample moved = sample;
    moved.points.colwise() += offset;
    if (sample.before)
      moved.before = Mixture(sample.before->weights(), sample.before->means().colwise() + offset,
                             sample.before->covariances());
    const Mixture here = estimate(GetParam(), sample);
    expect_near({here.weights(), here.means().colwise() + offset, here.covariances()},
                estimate(GetParam(), moved), scale_of(moved));
  });
}

TEST_P(Laws, ARepetitionIsWeight) {
  for_each_sample([](const Sample& sample) {
    std::vector<Eigen::Index> columns = columns_of(sample);
    Sample weighted = sample;
    for (Eigen::Index i = 3; i < sample.points.cols(); i += 5) {
      columns.push_back(i);
      weighted.weights[i] *= 2;
    }
    expect_near(estimate(GetParam(), weighted), estimate(GetParam(), sample.with_columns(columns)),
                scale_of(sample));
  });
}

TEST_P(Laws, DrawsStayWithinLimits) {
  for_each_sample([](const Sample& sample) {
    Eigen::Matrix2Xd limits(2, kJoints);
    limits.row(0) = sample.points.rowwise().minCoeff().transpose().array() - 0.1;
    limits.row(1) = sample.points.rowwise().maxCoeff().transpose().array() + 0.1;
    const mixture::Sampler sampler(estimate(GetParam(), sample), limits);
    std::mt19937_64 generator(kSeed);
    for (int i = 0; i < 50; ++i) {
      const std::optional<Eigen::VectorXd> draw = sampler.sample(generator);
      ASSERT_TRUE(draw);
      EXPECT_TRUE((draw->transpose().array() >= limits.row(0).array()).all());
      EXPECT_TRUE((draw->transpose().array() <= limits.row(1).array()).all());
    }
  });
}

/// What is no sample at all is refused with a reason, not fitted and no exception.
TEST_P(Laws, EqualPointsOnePointAndNoNumbersAreRefused) {
  const std::optional<Mixture> before = samples().front().before;
  const auto reason = [&before](const Eigen::MatrixXd& points) {
    Sample sample = test::sample_of("refused", points);
    sample.before = before;
    const Result<Mixture> made = test::try_estimate(GetParam(), sample, {});
    return made ? "accepted" : made.error().message;
  };
  const std::string few = "1 distinct configurations, need at least 4 for 3 joints";
  EXPECT_NE(reason(Eigen::MatrixXd::Constant(kJoints, kPoints, 0.5)).find(few), std::string::npos);
  EXPECT_NE(reason(Eigen::MatrixXd::Constant(kJoints, 1, 0.5)).find(few), std::string::npos);
  Eigen::MatrixXd damaged = clouds(kPoints);
  damaged(1, 17) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason(damaged).find("configuration 17 is not finite"), std::string::npos);
}

/// Then the heavy ones are what is left.
TEST_P(Laws, WeightsMayBeAsFarApartAsNumbersAre) {
  for (const double least : {std::numeric_limits<double>::denorm_min(), 1e-300}) {
    Sample sample = test::sample_of("weights", clouds(kPoints));
    sample.before = samples().front().before;
    sample.weights.setConstant(least);
    const Mixture light = estimate(GetParam(), sample);
    sample.weights.setOnes();
    expect_near(light, estimate(GetParam(), sample), scale_of(sample));
    sample.weights.setConstant(least);
    sample.weights.head(kPoints / 2).setConstant(1e300);
    const Mixture mixture = estimate(GetParam(), sample);
    EXPECT_NEAR(mixture.weights().sum(), 1, 1e-12);
    EXPECT_LT(
        (mixture.means() * mixture.weights() - sample.points.leftCols(kPoints / 2).rowwise().mean())
            .norm(),
        1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, Laws, testing::ValuesIn(test::kWays),
                         [](const auto& way) { return test::name_of(way.param); });

}  // namespace
}  // namespace kinship::density::laws_test
