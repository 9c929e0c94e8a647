// What other paths score under mixtures and under kernels, by the number of paths they are made of.
//
//   estimator_compare [FILE]
//
// FILE: paths of seven joints, kPointsPerBundlePath configurations each, as doubles, configuration
// after configuration; without one, bundles of curves. The last kTestPaths paths are never fitted.
// Printed is log(0.99 p + 0.01 u), nats, mean over the test paths and kDraws draws of training
// paths; u is uniform within the box of all.

#include <chrono>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <numeric>
#include <random>
#include <vector>

#include "server/density/block_points.hpp"
#include "server/density/fit.hpp"
#include "server/density/kernel_density.hpp"
#include "tests/bench/bundles.hpp"

namespace kinship {
namespace {

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kLength = bench::kPointsPerBundlePath;
constexpr Eigen::Index kTestPaths = 100;
constexpr int kDraws = 3;

Eigen::MatrixXd read(const char* name) {
  std::ifstream file(name, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)),
                                std::istreambuf_iterator<char>());
  const auto* numbers = reinterpret_cast<const double*>(bytes.data());
  const auto columns = static_cast<Eigen::Index>(bytes.size() / sizeof(double)) / kDof;
  return Eigen::Map<const Eigen::MatrixXd>(numbers, kDof, columns / kLength * kLength);
}

/// Scores mixtures on configurations that none of them saw.
class Judge {
 public:
  explicit Judge(const Eigen::MatrixXd& all)
      : points_(points_of(all.rightCols(kTestPaths * kLength))), limits_(2, kDof), log_uniform_(0) {
    limits_.row(0) = all.rowwise().minCoeff().transpose();
    limits_.row(1) = all.rowwise().maxCoeff().transpose();
    log_uniform_ = -(limits_.row(1) - limits_.row(0)).array().log().sum();
  }
  double score(const Mixture& mixture) const {
    return mean_log_density(mixture, points_, density::kBackgroundShare, log_uniform_, {});
  }
  const Eigen::Matrix2Xd& limits() const noexcept { return limits_; }

 private:
  static density::BlockPoints points_of(const Eigen::MatrixXd& columns) {
    const Eigen::MatrixXd every_fifth = columns(Eigen::all, Eigen::seq(0, columns.cols() - 1, 5));
    const density::DistinctPoints distinct =
        density::distinct_points(every_fifth, Eigen::VectorXd::Ones(every_fifth.cols()));
    return {every_fifth, distinct, density::mean_of(every_fifth, distinct)};
  }
  density::BlockPoints points_;
  Eigen::Matrix2Xd limits_;
  double log_uniform_;
};

/// A score and what it took.
struct Line {
  double score = 0;
  double time_s = 0;
  std::string note;
};

template <typename Make>
void add(Line& line, const Judge& judge, const Make& make) {
  const auto begin = std::chrono::steady_clock::now();
  const auto made = make(line.note);
  line.time_s +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / kDraws;
  line.score += judge.score(made.mixture) / kDraws;
}

void compare(const Eigen::MatrixXd& all, const Judge& judge, std::uint32_t paths) {
  std::vector<Line> lines(4);
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(all.cols() / kLength - kTestPaths));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::mt19937_64 generator(static_cast<std::uint64_t>(draw) + 1);
    std::shuffle(order.begin(), order.end(), generator);
    Eigen::MatrixXd points(kDof, paths * kLength);
    density::FitOptions options{.limits = judge.limits()};
    for (std::uint32_t path = 0; path < paths; ++path) {
      points.middleCols(path * kLength, kLength) = all.middleCols(order[path] * kLength, kLength);
      options.path_of_configuration.insert(options.path_of_configuration.end(), kLength, path);
    }
    const Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
    for (const auto& [line, components] : {std::pair(0, 50), std::pair(1, 100), std::pair(2, 0)})
      add(lines[static_cast<std::size_t>(line)], judge, [&](std::string& note) {
        options.components = components;
        density::FitSummary fitted =
            density::fit_mixture(points, weights, options).value_or_throw();
        note += ' ' + std::to_string(fitted.mixture.size());
        return fitted;
      });
    add(lines[3], judge, [&](std::string& note) {
      density::KernelDensity made = density::estimate_kernel_density(
                                        points, weights,
                                        {.floors_of_joints = Eigen::VectorXd::Constant(kDof, 1e-4),
                                         .path_of_configuration = options.path_of_configuration,
                                         .limits = judge.limits()})
                                        .value_or_throw();
      note += ' ' + std::to_string(made.bandwidth.clusters) + ':' +
              std::to_string(made.bandwidth.scale).substr(0, 5);
      return made;
    });
  }
  const char* const names[] = {"K = 50", "K = 100", "K chosen", "kernels"};
  for (std::size_t i = 0; i < lines.size(); ++i)
    std::cout << std::setw(4) << paths << "  " << std::setw(9) << names[i] << std::fixed
              << std::setprecision(2) << std::setw(8) << lines[i].score << std::setprecision(3)
              << std::setw(8) << lines[i].time_s << " s " << lines[i].note << std::endl;
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  using namespace kinship;
  constexpr Eigen::Index kBundlePaths = 620;
  const Eigen::MatrixXd all = argc > 1 ? read(argv[1]) : bench::bundles(kBundlePaths * kLength);
  const Judge judge(all);
  for (const std::uint32_t paths : {2U, 3U, 5U, 9U, 15U, 30U, 60U, 120U})
    compare(all, judge, paths);
}
