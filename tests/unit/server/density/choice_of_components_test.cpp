// What fit_mixture does if it is to choose the number of components.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "server/density/fit.hpp"

namespace kinship::density::choice_of_components_test {
namespace {

constexpr std::uint64_t kSeed = 31;

struct Paths {
  Eigen::MatrixXd configurations;
  std::vector<std::uint32_t> path_of;
};

/// Paths of 20 points each, near one of `bundles` straight lines; each path keeps to its own side
/// of its line, so that a component more per path would fit the points but no other path.
Paths paths_of(std::uint32_t count, std::uint32_t bundles) {
  constexpr Eigen::Index kPoints = 20;
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  Paths paths{Eigen::MatrixXd(2, kPoints * count), {}};
  for (std::uint32_t path = 0; path < count; ++path) {
    const double place = 4 * (path % bundles);
    const double side = 0.2 * normal(generator);
    for (Eigen::Index i = 0; i < kPoints; ++i) {
      paths.configurations.col(path * kPoints + i)
          << static_cast<double>(i) / kPoints + 0.02 * normal(generator),
          place + side + 0.02 * normal(generator);
      paths.path_of.push_back(path);
    }
  }
  return paths;
}

FitOptions choosing(const Paths& paths) {
  FitOptions options;
  options.components = 0;
  options.path_of_configuration = paths.path_of;
  return options;
}

FitSummary fit(const Paths& paths, const FitOptions& options) {
  return fit_mixture(paths.configurations, Eigen::VectorXd::Ones(paths.configurations.cols()),
                     options)
      .value_or_throw();
}

TEST(HeldOutPaths, AreAFifthAndNoneBelowTen) {
  for (const std::uint32_t count : {10U, 12U, 500U}) {
    const std::vector<std::uint8_t> held_out = held_out_paths(count, 1);
    EXPECT_EQ(held_out.size(), count);
    EXPECT_EQ(std::accumulate(held_out.begin(), held_out.end(), 0U), count / 5);
    EXPECT_EQ(held_out, held_out_paths(count, 1));
  }
  EXPECT_NE(held_out_paths(500, 1), held_out_paths(500, 2));
  for (const std::uint32_t count : {10U, 13U, 61U}) {
    std::vector<int> times(count, 0);
    for (std::uint32_t fold = 0; fold < kFolds; ++fold) {
      const std::vector<std::uint8_t> part = held_out_paths(count, 1, fold);
      for (std::uint32_t path = 0; path < count; ++path)
        times[path] += part[path];
    }
    EXPECT_EQ(times, std::vector<int>(count, 1)) << "each path in one fold of " << count;
  }
  const std::vector<std::uint8_t> few = held_out_paths(9, 1);
  EXPECT_EQ(std::count(few.begin(), few.end(), 0), 9);
}

TEST(ChoiceOfComponents, FindsTheBundlesAndNotThePaths) {
  const Paths paths = paths_of(90, 6);
  const FitSummary summary = fit(paths, choosing(paths));
  EXPECT_GE(summary.mixture.size(), 5);
  EXPECT_LE(summary.mixture.size(), 10);
  ASSERT_GE(summary.curve.size(), 4U);
  const auto best = std::max_element(
      summary.curve.begin(), summary.curve.end(),
      [](const ComponentScore& a, const ComponentScore& b) { return a.score < b.score; });
  EXPECT_EQ(summary.held_out_score, best->score);
  EXPECT_LE(summary.mixture.size(), best->components);
  for (std::size_t i = 1; i < summary.curve.size(); ++i)
    EXPECT_LT(summary.curve[i].components, summary.curve[i - 1].components);
}

TEST(ChoiceOfComponents, ScoreIsThatOfAFitToTheOtherPathsAlone) {
  // One component: its fit to the training paths is their mean and covariance, written out here.
  const Paths paths = paths_of(30, 1);
  FitOptions options = choosing(paths);
  options.limits.resize(2, 2);
  options.limits << -1, -3,  //
      2, 3;
  const FitSummary summary = fit(paths, options);
  const std::vector<std::uint8_t> held_out = held_out_paths(30, 0);
  Eigen::MatrixXd training(2, 24 * 20), scored(2, 6 * 20);
  Eigen::Index trained = 0, left = 0;
  for (Eigen::Index i = 0; i < paths.configurations.cols(); ++i) {
    const bool is_held_out = held_out[paths.path_of[static_cast<std::size_t>(i)]] != 0;
    (is_held_out ? scored.col(left++) : training.col(trained++)) = paths.configurations.col(i);
  }
  const Eigen::VectorXd mean = training.rowwise().mean();
  const Eigen::MatrixXd centred = training.colwise() - mean;
  const Mixture one(Eigen::VectorXd::Ones(1), mean,
                    {centred * centred.transpose() / static_cast<double>(trained) +
                     1e-4 * Eigen::MatrixXd::Identity(2, 2)});
  const double expected =
      (0.99 * kinship::mixture::log_density(one, scored).array().exp() + 0.01 / (3 * 6))
          .log()
          .mean();
  ASSERT_EQ(summary.curve.back().components, 1);
  EXPECT_NEAR(summary.curve.back().score, expected, 1e-10);
}

TEST(ChoiceOfComponents, MixtureIsFittedToAllPaths) {
  const Paths paths = paths_of(40, 2);
  const FitSummary summary = fit(paths, choosing(paths));
  EXPECT_LT(
      (summary.mixture.means() * summary.mixture.weights() - paths.configurations.rowwise().mean())
          .norm(),
      1e-10);
}

TEST(ChoiceOfComponents, FewPathsHaveOneComponentPerFourAndNoScore) {
  for (const std::uint32_t count : {1U, 3U, 5U, 9U}) {
    const Paths paths = paths_of(count, 3);
    const FitSummary summary = fit(paths, choosing(paths));
    EXPECT_LE(summary.mixture.size(), std::max(1U, count / 4));
    EXPECT_TRUE(summary.curve.empty());
    EXPECT_FALSE(summary.held_out_score);
  }
  EXPECT_EQ(components_of_few_paths(1), 1);
  EXPECT_EQ(components_of_few_paths(9), 2);
}

TEST(ChoiceOfComponents, EqualPathsAreOneComponent) {
  Paths paths = paths_of(12, 1);
  paths.configurations = paths.configurations.leftCols(20).replicate(1, 12).eval();
  EXPECT_LE(fit(paths, choosing(paths)).mixture.size(), 3);  // 20 distinct points
}

TEST(ChoiceOfComponents, AGivenNumberIsHonoured) {
  const Paths paths = paths_of(90, 6);
  FitOptions options = choosing(paths);
  options.components = 9;
  const FitSummary summary = fit(paths, options);
  EXPECT_EQ(summary.mixture.size(), 9);
  EXPECT_TRUE(summary.curve.empty());
}

TEST(ChoiceOfComponents, SameBytesForAnyNumberOfThreads) {
  const Paths paths = paths_of(60, 4);
  FitOptions options = choosing(paths);
  const FitSummary one = fit(paths, options);
  for (const int threads : {2, 3}) {
    options.computation.threads = threads;
    const FitSummary several = fit(paths, options);
    EXPECT_EQ(several.mixture.means(), one.mixture.means());
    EXPECT_EQ(several.mixture.covariances(), one.mixture.covariances());
    EXPECT_EQ(several.curve, one.curve);
  }
}

TEST(ChoiceOfComponents, WithoutThePathsIsACallersBug) {
  const Paths paths = paths_of(12, 1);
  EXPECT_THROW(fit(paths, {.components = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::density::choice_of_components_test
