// What a prior of covariances does to a fit, and how it is chosen.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "server/density/fit.hpp"
#include "server/density/prior_search.hpp"

namespace kinship::density::prior_test {
namespace {

constexpr Eigen::Index kDof = 5;
constexpr Eigen::Index kPoints = 16;  // of a path
constexpr double kFloor = 1e-4;

struct Paths {
  Eigen::MatrixXd configurations;
  std::vector<std::uint32_t> path_of;
};

/// Straight ways near one of two, which bend a little each in its own way.
Paths paths_of(std::uint32_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const auto noise = [&](double deviation) {
    return Eigen::VectorXd::NullaryExpr(kDof, [&] { return deviation * normal(generator); }).eval();
  };
  Paths paths{Eigen::MatrixXd(kDof, kPoints * count), {}};
  for (std::uint32_t path = 0; path < count; ++path) {
    Eigen::VectorXd goal = Eigen::VectorXd::Constant(kDof, 1.5);
    goal[path % 2] *= -1;
    const Eigen::VectorXd end = goal + noise(0.2), start = noise(0.05), bend = noise(0.3);
    for (Eigen::Index i = 0; i < kPoints; ++i) {
      const double t = static_cast<double>(i) / (kPoints - 1);
      paths.configurations.col(path * kPoints + i) =
          (1 - t) * start + t * end + t * (1 - t) * bend + noise(0.01);
      paths.path_of.push_back(path);
    }
  }
  return paths;
}

/// As the default profile asks for it.
FitOptions choosing(const Paths& paths) {
  FitOptions options;
  options.components = 100;
  options.covariance_floor = kFloor;
  options.prior = kChosenPrior;
  options.path_of_configuration = paths.path_of;
  return options;
}

FitSummary fit(const Paths& paths, const FitOptions& options) {
  return fit_mixture(paths.configurations, Eigen::VectorXd::Ones(paths.configurations.cols()),
                     options)
      .value_or_throw();
}

double score(const Mixture& mixture, const Paths& others) {
  return kinship::mixture::log_density(mixture, others.configurations).mean();
}

void expect_same(const Mixture& one, const Mixture& other) {
  EXPECT_EQ(one.weights(), other.weights());
  EXPECT_EQ(one.means(), other.means());
  EXPECT_EQ(one.covariances(), other.covariances());
}

/// Two thin bundles are its hard case: recorded paths of four tasks are within 0.1, but for one.
TEST(Prior, OtherPathsAreDescribedNearlyAsByTheBestOfAGrid) {
  const Paths others = paths_of(200, 99);
  for (const std::uint32_t count : {20U, 50U, 200U}) {
    SCOPED_TRACE(count);
    const Paths paths = paths_of(count, count);
    double best = -std::numeric_limits<double>::infinity();
    for (const double floor : {1e-4, 1e-3, 1e-2, 4e-2})
      for (const int components : {1, 2, 3, 5, 7, 10, 14, 20, 30, 50, 100})
        best = std::max(
            best, score(fit(paths, {.components = components, .covariance_floor = floor}).mixture,
                        others));
    FitOptions options = choosing(paths);
    EXPECT_GT(score(fit(paths, options).mixture, others), best - 0.2);
    options.prior = 0;
    EXPECT_LT(score(fit(paths, options).mixture, others), best - 0.3) << "nothing to mend";
  }
}

TEST(Prior, OneComponentIsWidenedByItsShareOfThePoints) {
  const Paths paths = paths_of(12, 1);
  const Mixture without = fit(paths, {.components = 1, .covariance_floor = kFloor}).mixture;
  const FitSummary with = fit(paths, {.components = 1, .covariance_floor = kFloor, .prior = 48});
  const double widened = 48.0 / static_cast<double>(paths.configurations.cols());
  EXPECT_LT((with.mixture.covariance(0) - (1 + widened) * without.covariance(0)).norm(), 1e-12);
  EXPECT_LT((with.prior_scatter - 48 * without.covariance(0)).norm(), 1e-10);
  EXPECT_EQ(with.prior, 48);
}

TEST(Prior, FromTenPathsOnTheScoreIsTold) {
  const Paths paths = paths_of(10, 3);
  const FitSummary summary = fit(paths, choosing(paths));
  ASSERT_TRUE(summary.held_out_score);
  FitOptions options = choosing(paths);
  options.prior = 0;
  EXPECT_FALSE(fit(paths, options).held_out_score);
  EXPECT_TRUE(summary.curve.empty());
}

TEST(Prior, OnePathHasAFixedOne) {
  const Paths path = paths_of(1, 5);
  FitOptions options = choosing(path);
  const FitSummary chosen = fit(path, options);
  EXPECT_EQ(chosen.prior, kPriorOfOnePath);
  EXPECT_FALSE(chosen.held_out_score);
  options.prior = kPriorOfOnePath;
  expect_same(fit(path, options).mixture, chosen.mixture);
}

TEST(Prior, FewPathsChooseWithoutAScore) {
  for (const std::uint32_t count : {2U, 9U}) {
    const Paths paths = paths_of(count, 6);
    const FitSummary summary = fit(paths, choosing(paths));
    EXPECT_GT(summary.prior, 0);
    EXPECT_FALSE(summary.held_out_score);
  }
}

TEST(Prior, SameBytesForAnyNumberOfThreads) {
  const Paths paths = paths_of(80, 8);
  FitOptions options = choosing(paths);
  const FitSummary one = fit(paths, options);
  options.computation.threads = 3;
  const FitSummary three = fit(paths, options);
  expect_same(three.mixture, one.mixture);
  EXPECT_EQ(three.held_out_score, one.held_out_score);
}

TEST(Prior, AWarmStartKeepsIt) {
  const Paths paths = paths_of(20, 9);
  FitOptions options = choosing(paths);
  const FitSummary full = fit(paths, options);
  const std::vector<std::uint8_t> is_new(paths.path_of.size(), 0);
  options.warm_start = WarmStart{full.mixture, is_new, full.prior_scatter};
  const FitSummary kept = fit(paths, options);
  EXPECT_EQ(kept.prior_scatter, full.prior_scatter);
  const Paths others = paths_of(200, 99);
  EXPECT_NEAR(score(kept.mixture, others), score(full.mixture, others), 0.1);
  options.warm_start->prior_scatter.resize(0, 0);
  EXPECT_LT(score(fit(paths, options).mixture, others), score(full.mixture, others) - 0.3);
}

TEST(Prior, AlsoWhereComponentsAreChosen) {
  const Paths paths = paths_of(60, 10), others = paths_of(200, 99);
  FitOptions options = choosing(paths);
  options.components = 0;
  const FitSummary with = fit(paths, options);
  EXPECT_GT(with.prior, 0);
  ASSERT_FALSE(with.curve.empty());
  options.prior = 0;
  EXPECT_GT(score(with.mixture, others), score(fit(paths, options).mixture, others));
}

TEST(Prior, OutsideItsRangeOrWithoutPathsIsACallersBug) {
  const Paths paths = paths_of(12, 11);
  FitOptions options = choosing(paths);
  for (const double bad :
       {-2.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    options.prior = bad;
    EXPECT_THROW(fit(paths, options), std::invalid_argument) << bad;
  }
  EXPECT_THROW(fit(paths, {.components = 5, .prior = kChosenPrior}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::density::prior_test
