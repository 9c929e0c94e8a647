// One side of a comparison with other libraries: writes points and starts of EM to a folder, runs
// our EM from them and prints CPU time and log-likelihood. fit_compare.py runs all sides.
//
//   fit_compare FOLDER
//
// FOLDER/points_D.bin is D x N, FOLDER/start_D_K.bin the weights, means (D x K) and covariances
// (D x D x K) of a start; doubles, column by column.

#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <string>

#include "server/density/em_run.hpp"
#include "server/density/fit.hpp"
#include "tests/bench/bundles.hpp"

namespace kinship {
namespace {

constexpr Eigen::Index kCount = 72'160;
constexpr int kIterations = 7;

double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void write(std::ofstream& file, const Eigen::MatrixXd& matrix) {
  for (const double value : matrix.reshaped())
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_start(const std::string& name, const Mixture& mixture) {
  std::ofstream file(name, std::ios::binary);
  write(file, mixture.weights());
  write(file, mixture.means());
  for (const Eigen::MatrixXd& covariance : mixture.covariances())
    write(file, covariance);
}

void print(const std::string& what, Eigen::Index dimension, Eigen::Index components, double time_ms,
           double log_likelihood) {
  std::cout << what << ' ' << dimension << ' ' << components << ' ' << time_ms << ' '
            << std::setprecision(16) << log_likelihood << std::setprecision(6) << std::endl;
}

void compare(const std::string& folder, Eigen::Index dimension, Eigen::Index components) {
  const Eigen::MatrixXd configurations = bench::bundles(kCount, dimension);
  {
    std::ofstream file(folder + "/points_" + std::to_string(dimension) + ".bin", std::ios::binary);
    write(file, configurations);
  }
  const density::DistinctPoints distinct =
      density::distinct_points(configurations, Eigen::VectorXd::Ones(kCount));
  const density::BlockPoints points(configurations, distinct,
                                    density::mean_of(configurations, distinct));
  density::EmOptions options{.floors = Eigen::VectorXd::Constant(dimension, 1e-4),
                             .max_iterations = kIterations,
                             .tolerance = -1};
  const Mixture start = density::start_mixture(points, components, 0, options);
  write_start(
      folder + "/start_" + std::to_string(dimension) + "_" + std::to_string(components) + ".bin",
      start);
  for (const bool prune : {true, false}) {
    options.computation.prune = prune;
    density::run_em(start, points, options);  // warms caches
    const double begin = cpu_s();
    const density::EmRun run = density::run_em(start, points, options);
    // One E-step more than iterations, and as many M-steps.
    print(prune ? "pruned" : "dense", dimension, components,
          1000 * (cpu_s() - begin) / (kIterations + 1), run.log_likelihoods.back());
  }
}

void compare_whole_fits() {
  const Eigen::MatrixXd configurations = bench::bundles(kCount);
  density::FitOptions options;
  options.components = 0;
  for (Eigen::Index i = 0; i < kCount; ++i)
    options.path_of_configuration.push_back(
        static_cast<std::uint32_t>(i / bench::kPointsPerBundlePath));
  for (const int components : {0, 50}) {
    options.components = components;
    const double begin = cpu_s();
    const density::FitSummary fitted =
        density::fit_mixture(configurations, Eigen::VectorXd::Ones(kCount), options)
            .value_or_throw();
    print(components == 0 ? "fit-choosing" : "fit", 7, fitted.mixture.size(),
          1000 * (cpu_s() - begin), fitted.log_likelihoods.back());
  }
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: fit_compare FOLDER\n";
    return 2;
  }
  for (const int components : {10, 30, 50, 100})
    kinship::compare(argv[1], 7, components);
  for (const int dimension : {5, 6, 8})
    kinship::compare(argv[1], dimension, 50);
  kinship::compare_whole_fits();
  return 0;
}
