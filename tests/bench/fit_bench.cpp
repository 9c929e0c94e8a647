#include <benchmark/benchmark.h>

#include <random>

#include "proto/mixture/density.hpp"
#include "proto/mixture/sampler.hpp"
#include "server/density/expectation_maximisation.hpp"
#include "server/density/fit.hpp"

namespace kinship {
namespace {

constexpr Eigen::Index kDimension = 7;
constexpr int kComponents = 50;

/// Waypoints of curved bundles: 24 prototypes of cubic curves, paths of 145 points near them.
Eigen::MatrixXd bundles(Eigen::Index count) {
  constexpr Eigen::Index kPrototypes = 24;
  constexpr Eigen::Index kPathPoints = 145;
  constexpr Eigen::Index kControls = 4;
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd prototypes = Eigen::MatrixXd::NullaryExpr(
      kDimension, kPrototypes * kControls, [&] { return uniform(generator); });
  Eigen::MatrixXd points(kDimension, count);
  Eigen::MatrixXd controls(kDimension, kControls);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index on_path = i % kPathPoints;
    if (on_path == 0)
      controls = prototypes.middleCols(kControls * (i / kPathPoints % kPrototypes), kControls) +
                 0.15 * Eigen::MatrixXd::NullaryExpr(kDimension, kControls,
                                                     [&] { return normal(generator); });
    const double t = static_cast<double>(on_path) / static_cast<double>(kPathPoints - 1);
    const double s = 1 - t;
    const Eigen::Vector4d bernstein(s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t);
    points.col(i) = controls * bernstein + 0.004 * Eigen::VectorXd::NullaryExpr(kDimension, [&] {
                                             return normal(generator);
                                           });
  }
  return points;
}

density::FitSummary fit(const Eigen::MatrixXd& points, int max_iterations) {
  const density::FitOptions options{.components = kComponents, .max_iterations = max_iterations};
  return density::fit_mixture(points, Eigen::VectorXd::Ones(points.cols()), options)
      .value_or_throw();
}

void em_iteration(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(state.range(0));
  const density::WeightedPoints points =
      density::prepare_points(configurations, Eigen::VectorXd::Ones(configurations.cols()));
  const Mixture start = fit(configurations, 1).mixture;
  const Mixture centred(start.weights(), start.means().colwise() - points.offset,
                        start.covariances());
  for (auto _ : state)
    benchmark::DoNotOptimize(
        density::maximisation(density::expectation(centred, points).moments, 1e-4));
}
BENCHMARK(em_iteration)->Arg(15'000)->Arg(72'160)->Unit(benchmark::kMillisecond);

void whole_fit(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(state.range(0));
  std::size_t iterations = 0;
  for (auto _ : state)
    iterations = fit(configurations, 50).log_likelihoods.size();
  state.counters["iterations"] = static_cast<double>(iterations);
}
BENCHMARK(whole_fit)->Arg(15'000)->Arg(72'160)->Unit(benchmark::kMillisecond);

void start_only(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(fit(configurations, 0));
}
BENCHMARK(start_only)->Arg(15'000)->Arg(72'160)->Unit(benchmark::kMillisecond);

void sample(benchmark::State& state) {
  Eigen::Matrix2Xd limits(2, kDimension);
  limits.row(0).setConstant(-2.5);
  limits.row(1).setConstant(2.5);
  const mixture::Sampler sampler(fit(bundles(15'000), 10).mixture, limits);
  std::mt19937_64 generator(5);
  for (auto _ : state)
    benchmark::DoNotOptimize(sampler.sample(generator));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(sample);

void log_density_of_all(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(15'000);
  const Mixture mixture = fit(configurations, 10).mixture;
  for (auto _ : state)
    benchmark::DoNotOptimize(mixture::log_density(mixture, configurations));
  state.SetItemsProcessed(state.iterations() * configurations.cols());
}
BENCHMARK(log_density_of_all)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kinship

BENCHMARK_MAIN();
