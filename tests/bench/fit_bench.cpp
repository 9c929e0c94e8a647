#include <benchmark/benchmark.h>

#include <random>

#include "proto/mixture/sampler.hpp"
#include "server/density/block_points.hpp"
#include "server/density/expectation_maximisation.hpp"
#include "server/density/fit.hpp"
#include "tests/bench/bundles.hpp"

namespace kinship {
namespace {

using bench::bundles;

constexpr Eigen::Index kDimension = 7;
constexpr Eigen::Index kPaperConfigurations = 72'160;
constexpr int kComponents = 50;

density::FitSummary fit(const Eigen::MatrixXd& points, int max_iterations,
                        int components = kComponents) {
  const density::FitOptions options{.components = components, .max_iterations = max_iterations};
  return density::fit_mixture(points, Eigen::VectorXd::Ones(points.cols()), options)
      .value_or_throw();
}

/// Arguments: dimension, components, instruction set, whether pruned.
void em_iteration(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(kPaperConfigurations, state.range(0));
  const density::DistinctPoints distinct =
      density::distinct_points(configurations, Eigen::VectorXd::Ones(configurations.cols()));
  const density::BlockPoints points(configurations, distinct,
                                    density::mean_of(configurations, distinct));
  const Mixture start = fit(configurations, 3, static_cast<int>(state.range(1))).mixture;
  const Eigen::VectorXd floors = Eigen::VectorXd::Constant(state.range(0), 1e-4);
  density::Computation computation{.prune = state.range(3) != 0};
  computation.kernels =
      density::find_simd_kernels(static_cast<density::InstructionSet>(state.range(2)));
  if (computation.kernels == nullptr)
    return state.SkipWithError("this machine does not have it");
  state.SetLabel(computation.kernels->name);
  for (auto _ : state)
    benchmark::DoNotOptimize(density::maximisation(
        density::expectation(start, points, computation).moments, points.offset(), floors));
}
BENCHMARK(em_iteration)
    ->ArgNames({"d", "K", "set", "prune"})
    ->ArgsProduct({{7}, {10, 30, 50, 100}, {2}, {0, 1}})
    ->ArgsProduct({{7}, {50}, {0, 1}, {0, 1}})
    ->ArgsProduct({{5, 6, 8}, {50}, {2}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

void whole_fit(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(state.range(0));
  std::size_t iterations = 0;
  for (auto _ : state)
    iterations = fit(configurations, 50).log_likelihoods.size();
  state.counters["iterations"] = static_cast<double>(iterations);
}
/// K chosen: a ladder of components scored on held-out paths, then a fit to all.
void fit_with_choice(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(state.range(0));
  density::FitOptions options;
  options.components = 0;
  options.computation.threads = static_cast<int>(state.range(1));
  for (Eigen::Index i = 0; i < configurations.cols(); ++i)
    options.path_of_configuration.push_back(
        static_cast<std::uint32_t>(i / bench::kPointsPerBundlePath));
  Eigen::Index components = 0;
  for (auto _ : state)
    components =
        density::fit_mixture(configurations, Eigen::VectorXd::Ones(configurations.cols()), options)
            .value_or_throw()
            .mixture.size();
  state.counters["components"] = static_cast<double>(components);
}
BENCHMARK(fit_with_choice)
    ->ArgNames({"N", "threads"})
    ->Args({15'000, 1})
    ->Args({kPaperConfigurations, 1})
    ->Args({kPaperConfigurations, 2})
    ->Args({1'000'000, 1})
    ->Args({1'000'000, 2})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK(whole_fit)
    ->Arg(15'000)
    ->Arg(kPaperConfigurations)
    ->Arg(1'000'000)
    ->Unit(benchmark::kMillisecond);

void start_only(benchmark::State& state) {
  const Eigen::MatrixXd configurations = bundles(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(fit(configurations, 0));
}
BENCHMARK(start_only)->Arg(15'000)->Arg(kPaperConfigurations)->Unit(benchmark::kMillisecond);

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

}  // namespace
}  // namespace kinship

BENCHMARK_MAIN();
