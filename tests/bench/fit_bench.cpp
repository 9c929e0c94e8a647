// EM, whole fits and samples of mixtures: 72 160 configurations of seven joints, as many as the
// paper has, in bundles of curves. CPU time of the process, one thread each.
//
//   fit_bench em [--no-references]    an iteration, beside scikit-learn and Armadillo from the same
//   start fit_bench fit [--no-references]   whole fits, beside one of scikit-learn; a sample

#include <cstdint>
#include <fstream>
#include <random>
#include <string>

#include "proto/mixture/sampler.hpp"
#include "server/density/em_run.hpp"
#include "server/density/fit.hpp"
#include "tests/bench/bundles.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/reference.hpp"
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
        {"/usr/bin/python3", KINSHIP_SOURCE_DIR "/tests/bench/reference_sklearn.py", what,
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
  std::mt19937_64 generator(5);
  double sum = 0;  // so that the work is not left out
  const double taken_s = least_s(5, process_cpu_s, [&] {
    for (int i = 0; i < kSamples; ++i)
      sum += sampler.sample(generator).value()[0];
  });
  print({.name = "a sample within limits, K = 100",
         .value = 1e9 * taken_s / kSamples,
         .unit = "ns",
         .budget = 50,
         .note = "mean of joint 1 " + number(sum / (5 * kSamples))});
}

int run(const std::string& what, bool has_references) {
  const Eigen::MatrixXd configurations = bundles(kConfigurations, kDof);
  const Case references(configurations);
  if (what == "em") {
    for (const int components : {50, 100})
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
  return kinship::bench::run(argc > 1 ? argv[1] : "em",
                             kinship::bench::wants_references(argc, argv));
}
