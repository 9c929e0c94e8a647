// EM, whole fits and samples of mixtures: 72 160 configurations of seven joints, as many as the
// paper has, in bundles of curves. CPU time of the process, one thread each.
//
//   fit_bench em [--no-references]    an iteration, beside scikit-learn and Armadillo from the same
//                                     start
//   fit_bench fit [--no-references]   whole fits, beside one of scikit-learn; a sample
//   fit_bench scores [ROWS.csv...]    how well the default profile describes held-out paths, beside
//                                     a grid; of files of `kinship configurations export`, or of
//                                     few and many of the same bundles

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "proto/mixture/sampler.hpp"
#include "server/density/em_run.hpp"
#include "server/density/fit.hpp"
#include "server/density/fit_input.hpp"
#include "tests/bench/bundles.hpp"
#include "tests/bench/exported_rows.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/processor.hpp"
#include "tests/bench/reference.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::bench {
namespace {

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kConfigurations = 72'160;
constexpr int kIterations = 7;
constexpr double kFloor = 1e-4;

void write(const std::filesystem::path& file, const std::vector<Eigen::MatrixXd>& matrices) {
  std::ofstream stream(file, std::ios::binary);
  for (const Eigen::MatrixXd& matrix : matrices)
    stream.write(reinterpret_cast<const char*>(matrix.data()),
                 static_cast<std::streamsize>(sizeof(double)) * matrix.size());
}

/// What references read: doubles, column by column; of the start weights, means and covariances.
class Case {
 public:
  explicit Case(const Eigen::MatrixXd& configurations) {
    write(folder_ / "points", {configurations});
  }
  void write_start(const Mixture& start) const {
    std::vector<Eigen::MatrixXd> parts = {start.weights(), start.means()};
    for (const Eigen::MatrixXd& covariance : start.covariances())
      parts.push_back(covariance);
    write(folder_ / "start", parts);
  }
  /// \return CPU ms and mean log-likelihood.
  std::vector<double> scikit_learn(const std::string& what, Eigen::Index components) const {
    return run_reference(
        {"/usr/bin/python3", test::source_dir() + "/tests/bench/reference_sklearn.py", what,
         folder_.path().string(), std::to_string(kDof), std::to_string(components)},
        2);
  }
  double armadillo_ms(Eigen::Index components) const {
    return run_reference({beside_this_program("reference_armadillo"), folder_.path().string(),
                          std::to_string(kDof), std::to_string(components)},
                         1)[0];
  }

 private:
  test::TemporaryDirectory folder_;
};

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void em_iteration(const Eigen::MatrixXd& configurations, int components, const Case* references) {
  const density::DistinctPoints distinct =
      density::distinct_points(configurations, Eigen::VectorXd::Ones(configurations.cols()));
  const density::BlockPoints points(configurations, distinct,
                                    density::mean_of(configurations, distinct));
  const density::EmOptions options{.floors = Eigen::VectorXd::Constant(kDof, kFloor),
                                   .max_iterations = kIterations,
                                   .tolerance = -1};
  const Mixture start = density::start_mixture(points, components, 0, options);
  double log_likelihood = 0;
  const double least = least_s(5, process_cpu_s, [&] {
    log_likelihood = density::run_em(start, points, options).log_likelihoods.back();
  });
  // One E-step more than iterations, and as many M-steps.
  const double ours_ms = 1e3 * least / (kIterations + 1);
  const std::string name = "EM iteration, K = " + std::to_string(components);
  if (references == nullptr)
    return print({.name = name, .value = ours_ms, .unit = "ms"});
  references->write_start(start);
  const std::vector<double> sklearn = references->scikit_learn("em", components);
  print({.name = name + ", to scikit-learn",
         .value = ours_ms,
         .unit = "ms",
         .reference = Reference{"scikit-learn", sklearn[0]},
         .ratio_budget = 1.0 / 100,
         .note = "log-likelihoods after " + std::to_string(kIterations) + " iterations differ by " +
                 number(log_likelihood - sklearn[1])});
  print({.name = name + ", to Armadillo",
         .value = ours_ms,
         .unit = "ms",
         .reference = Reference{"Armadillo", references->armadillo_ms(components)},
         .ratio_budget = 1.0 / 50});
}

/// \param components  0: chosen on held-out paths.
void whole_fit(const Eigen::MatrixXd& configurations, int components,
               const std::optional<Reference>& reference) {
  density::FitOptions options;
  options.components = components;
  for (Eigen::Index i = 0; i < configurations.cols(); ++i)
    options.path_of_configuration.push_back(static_cast<std::uint32_t>(i / kPointsPerBundlePath));
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(configurations.cols());
  Eigen::Index fitted = 0;
  double log_likelihood = 0;
  const double taken_s = least_s(3, process_cpu_s, [&] {
    const density::FitSummary summary =
        density::fit_mixture(configurations, weights, options).value_or_throw();
    fitted = summary.mixture.size();
    log_likelihood = summary.log_likelihoods.back();
  });
  Figure figure{
      .name = "fit, K " + (components == 0 ? "chosen" : "= " + std::to_string(components)) +
              ", N = " + std::to_string(configurations.cols()),
      .value = taken_s,
      .unit = "s",
      .reference = reference,
      .note = "K = " + std::to_string(fitted) + ", log-likelihood " + number(log_likelihood)};
  if (reference && components == 0)
    figure.ratio_budget = 1.0 / 10;
  print(figure);
}

void sample(const Eigen::MatrixXd& configurations) {
  constexpr int kComponents = 100;
  constexpr int kSamples = 200'000;
  const Mixture mixture =
      density::fit_mixture(configurations, Eigen::VectorXd::Ones(configurations.cols()),
                           {.components = kComponents})
          .value_or_throw()
          .mixture;
  Eigen::Matrix2Xd limits(2, kDof);
  limits.row(0).setConstant(-2.5);
  limits.row(1).setConstant(2.5);
  const mixture::Sampler sampler(mixture, limits);
  constexpr int kAtOnce = 4096;
  std::mt19937_64 generator(5);
  double sum = 0;  // so that the work is not left out
  const double alone_s = least_s(5, process_cpu_s, [&] {
    for (int i = 0; i < kSamples; ++i)
      sum += sampler.sample(generator).value()[0];
  });
  print({.name = "a sample within limits, K = 100",
         .value = 1e9 * alone_s / kSamples,
         .unit = "ns",
         .note = "mean of joint 1 " + number(sum / (5 * kSamples))});
  const double together_s =
      least_s(50, process_cpu_s, [&] { sum += sampler.sample(generator, kAtOnce)(0, 0); });
  print({.name = "a sample of " + std::to_string(kAtOnce) + " within limits, K = 100",
         .value = 1e9 * together_s / kAtOnce,
         .unit = "ns",
         .reference = time_at_best(3500, 1e-9),
         .ratio_budget = 1});
}

/// The mean over five folds of paths of the mean log density of what is held out, nats.
double held_out_score(const Rows& rows, density::FitOptions options) {
  const std::uint32_t paths = 1 + *std::max_element(rows.path_of.begin(), rows.path_of.end());
  double sum = 0;
  for (std::uint32_t fold = 0; fold < density::kFolds; ++fold) {
    // Another seed than that of fits, so that what they hold out by themselves is none of it.
    std::vector<std::uint8_t> is_held_out = density::held_out_paths(paths, 12345, fold);
    const Rows held_out = rows_of(rows, is_held_out);
    for (std::uint8_t& flag : is_held_out)
      flag = flag == 0 ? 1 : 0;
    const Rows training = rows_of(rows, is_held_out);
    options.path_of_configuration = training.path_of;
    const Mixture mixture = density::fit_mixture(training.configurations, training.weights, options)
                                .value_or_throw()
                                .mixture;
    const density::DistinctPoints points =
        density::distinct_points(held_out.configurations, held_out.weights);
    sum += density::mean_log_density(
        mixture,
        {held_out.configurations, points, density::mean_of(held_out.configurations, points)}, 0, 0,
        {});
  }
  return sum / density::kFolds;
}

density::FitOptions default_options(double prior) {
  const DensityParameters parameters;
  return {.components = parameters.components,
          .covariance_floor = parameters.covariance_floor,
          .prior = prior};
}

void score(const std::string& name, const Rows& rows) {
  Reference best{"", -1e300};
  for (const double floor : {1e-4, 1e-3, 1e-2, 4e-2})
    for (const int components : {1, 2, 3, 5, 7, 10, 14, 20, 30, 50, 100}) {
      const double score =
          held_out_score(rows, {.components = components, .covariance_floor = floor});
      if (score > best.value)
        best = {"grid, K = " + std::to_string(components) + ", floor " + number(floor), score};
    }
  print({.name = name + ": held-out paths",
         .value = held_out_score(rows, default_options(kChosenPrior)),
         .unit = "nats",
         .better = Better::Higher,
         .reference = best,
         .budget = best.value - 0.1,
         .note = "without a prior " + number(held_out_score(rows, default_options(0)))});
  const auto taken_s = [&rows](double prior) {
    density::FitOptions options = default_options(prior);
    options.path_of_configuration = rows.path_of;
    return least_s(3, process_cpu_s, [&] {
      density::fit_mixture(rows.configurations, rows.weights, options).value_or_throw();
    });
  };
  print({.name = name + ": fit",
         .value = 1e3 * taken_s(kChosenPrior),
         .unit = "ms",
         .reference = Reference{"without a prior", 1e3 * taken_s(0)},
         .ratio_budget = 1.5,
         .note = std::to_string(rows.path_of.size()) + " configurations"});
}

/// Every tenth waypoint of bundles.
Rows rows_of_bundles(Eigen::Index paths) {
  const Eigen::MatrixXd all = bundles(paths * kPointsPerBundlePath, kDof);
  std::vector<Eigen::Index> columns;
  Rows rows;
  for (Eigen::Index i = 0; i < all.cols(); i += 10) {
    columns.push_back(i);
    rows.path_of.push_back(static_cast<std::uint32_t>(i / kPointsPerBundlePath));
  }
  rows.configurations = all(Eigen::all, columns);
  rows.weights.setOnes(static_cast<Eigen::Index>(columns.size()));
  return rows;
}

void scores(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    score(file, read_rows(file));
  if (files.empty())
    for (const Eigen::Index paths : {50, 500})
      score(std::to_string(paths) + " paths of bundles", rows_of_bundles(paths));
}

int run(const std::string& what, bool has_references) {
  const Eigen::MatrixXd configurations = bundles(kConfigurations, kDof);
  const Case references(configurations);
  if (what == "em") {
    for (const int components : {10, 50, 100})
      em_iteration(configurations, components, has_references ? &references : nullptr);
    return 0;
  }
  std::optional<Reference> sklearn;
  if (has_references)
    sklearn = Reference{"scikit-learn, K = 50", 1e-3 * references.scikit_learn("fit", 50)[0]};
  whole_fit(configurations, 50, sklearn);
  whole_fit(configurations, 0, sklearn);
  whole_fit(bundles(1'000'000, kDof), 0, std::nullopt);
  sample(configurations);
  return 0;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  if (argc > 1 && argv[1] == std::string_view("scores")) {
    std::vector<std::string> files(argv + 2, argv + argc);
    std::erase(files, "--no-references");
    kinship::bench::scores(files);
    return 0;
  }
  return kinship::bench::run(argc > 1 ? argv[1] : "em",
                             kinship::bench::wants_references(argc, argv));
}
