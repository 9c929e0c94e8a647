// A fit that begins with the mixture of a fit before.

#include "server/density/warm_start.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "server/density/fit.hpp"

namespace kinship::density::warm_start_test {
namespace {

constexpr int kComponents = 8;
constexpr Eigen::Index kPoints = 200;  // of a cloud

/// Clouds of points, kPoints each, around these places of the plane.
Eigen::MatrixXd clouds(const std::vector<double>& places, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd points(2, kPoints * static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    points.col(i) << places[static_cast<std::size_t>(i / kPoints)] + 0.1 * normal(generator),
        0.1 * normal(generator);
  return points;
}

Result<FitSummary> try_fit(const Eigen::MatrixXd& points, const FitOptions& options) {
  return fit_mixture(points, Eigen::VectorXd::Ones(points.cols()), options);
}

FitOptions fixed() { return {.components = kComponents}; }

/// Three clouds fitted before, and what is new.
struct Grown {
  explicit Grown(const Eigen::MatrixXd& added) : configurations(2, 3 * kPoints + added.cols()) {
    configurations << clouds({0, 1, 2}, 1), added;
    warm.is_new.assign(static_cast<std::size_t>(configurations.cols()), 1);
    std::fill_n(warm.is_new.begin(), 3 * kPoints, std::uint8_t{0});
  }
  FitOptions options() const {
    FitOptions options = fixed();
    options.warm_start = warm;
    return options;
  }
  Mixture refit(const FitOptions& options) const {
    return try_fit(configurations, options).value_or_throw().mixture;
  }
  Eigen::MatrixXd configurations;
  WarmStart warm{try_fit(clouds({0, 1, 2}, 1), fixed()).value_or_throw().mixture, {}};
};

double mean_score(const Mixture& mixture, const Eigen::MatrixXd& points) {
  return kinship::mixture::log_density(mixture, points).mean();
}

TEST(WarmStart, ANewCloudFarAwayGetsComponentsOfItsOwn) {
  const Grown grown(clouds({9}, 2));
  const Mixture warm = grown.refit(grown.options());
  const Mixture cold = grown.refit(fixed());
  EXPECT_LE(warm.size(), kComponents);
  const Eigen::MatrixXd others = clouds({0, 1, 2, 9}, 3);
  EXPECT_GT(mean_score(warm, others), mean_score(cold, others) - 0.05);
  EXPECT_GT(mean_score(warm, clouds({9}, 4)), mean_score(cold, clouds({9}, 4)) - 0.1);
}

TEST(WarmStart, MoreOfTheSameAddsNoComponent) {
  const Grown grown(clouds({1}, 2));
  const auto start_of = [](const Grown& grown_so) {
    const Eigen::MatrixXd& configurations = grown_so.configurations;
    const EmOptions em{.floors = Eigen::VectorXd::Constant(2, 1e-4)};
    return with_components_for_new(
        configurations,
        distinct_points(configurations, Eigen::VectorXd::Ones(configurations.cols())),
        grown_so.warm, 0, em);
  };
  EXPECT_EQ(start_of(grown).size(), grown.warm.mixture.size());
  const Grown far(clouds({9}, 2));
  const Mixture longer = start_of(far);
  EXPECT_GT(longer.size(), far.warm.mixture.size());
  EXPECT_LE(longer.size(), far.warm.mixture.size() + kMaxNewComponents);
  EXPECT_NEAR(longer.weights().sum(), 1, 1e-12);
}

TEST(WarmStart, ManyPointsAreSeenAFewTimesAndDescribedAsWell) {
  std::vector<double> places;
  for (int i = 0; i < 150; ++i)
    places.push_back(i % 3);
  const Eigen::MatrixXd before = clouds(places, 5);
  Eigen::MatrixXd all(2, before.cols() + 5 * kPoints);
  all << before, clouds({9, 9, 9, 1, 1}, 6);
  ASSERT_GT(all.cols(), kSamplePoints);
  FitOptions options = fixed();
  const Mixture cold = try_fit(all, options).value_or_throw().mixture;
  options.warm_start = WarmStart{try_fit(before, options).value_or_throw().mixture, {}};
  options.warm_start->is_new.assign(static_cast<std::size_t>(all.cols()), 0);
  std::fill(options.warm_start->is_new.begin() + before.cols(), options.warm_start->is_new.end(),
            std::uint8_t{1});
  const FitSummary warm = try_fit(all, options).value_or_throw();
  EXPECT_LE(warm.log_likelihoods.size(), static_cast<std::size_t>(kWarmPasses));
  EXPECT_EQ(warm.mixture.size(), kComponents);
  const Eigen::MatrixXd others = clouds({0, 1, 2, 0, 1, 2, 0, 1, 2, 9}, 7);
  EXPECT_GT(mean_score(warm.mixture, others), mean_score(cold, others) - 0.02);
}

TEST(WarmStart, AChosenNumberOfComponentsStays) {
  const Grown grown(clouds({9}, 2));
  FitOptions options = grown.options();
  options.components = 0;  // and no paths: nothing is chosen again
  const FitSummary summary = try_fit(grown.configurations, options).value_or_throw();
  EXPECT_EQ(summary.mixture.size(), grown.warm.mixture.size());
  EXPECT_TRUE(summary.curve.empty());
  EXPECT_FALSE(summary.held_out_score);
}

TEST(WarmStart, NothingNewOrNothingOldIsFittedAllTheSame) {
  const Grown grown(clouds({1}, 2));
  for (const std::uint8_t flag : {std::uint8_t{0}, std::uint8_t{1}}) {
    FitOptions options = grown.options();
    std::fill(options.warm_start->is_new.begin(), options.warm_start->is_new.end(), flag);
    EXPECT_LE(grown.refit(options).size(), kComponents);
  }
}

TEST(WarmStart, KernelsAreAMixtureToBeginWithToo) {
  Grown grown(clouds({9}, 2));
  const Mixture& before = grown.warm.mixture;
  grown.warm.mixture = Mixture(before.weights(), before.means(), {before.covariance(0)});
  const Mixture warm = grown.refit(grown.options());
  EXPECT_EQ(warm.covariances().size(), static_cast<std::size_t>(warm.size()));
  EXPECT_GT(mean_score(warm, clouds({9}, 4)),
            mean_score(grown.refit(fixed()), clouds({9}, 4)) - 0.3);
}

TEST(WarmStart, OtherSizesAreRefused) {
  const Grown grown(clouds({1}, 2));
  FitOptions options = grown.options();
  options.warm_start->is_new.pop_back();
  EXPECT_THROW(try_fit(grown.configurations, options), std::invalid_argument);
  options = grown.options();
  const Eigen::MatrixXd solid = Eigen::MatrixXd::Random(3, grown.configurations.cols());
  EXPECT_THROW(try_fit(solid, options), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::density::warm_start_test
