#include "server/density/em_run.hpp"

#include <Eigen/Cholesky>
#include <random>
#include <utility>

#include "server/density/kmeans.hpp"

namespace kinship::density {
namespace {

constexpr int kLloydIterations = 3;

/// Per point, nats, but for a constant.
double log_prior(const Mixture& mixture, const BlockPoints& points, const EmOptions& options) {
  if (options.prior_scatter.size() == 0)
    return 0;
  double sum = 0;
  for (Eigen::Index k = 0; k < mixture.size(); ++k)
    sum -= 0.5 * mixture.covariance(k).llt().solve(options.prior_scatter).trace();
  return sum / points.total_weight();
}

enum class LastStep { Judged, AsItIs };

/// \param current  of `start`.
/// \param last     whether the likelihood after the last iteration that there may be is asked for.
EmRun iterate(Mixture start, Expectation current, const BlockPoints& points,
              const EmOptions& options, LastStep last) {
  EmRun run{std::move(start), {}};
  double posterior = current.mean_log_likelihood + log_prior(run.mixture, points, options);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    run.mixture = maximisation(current.moments, points.offset(), options.floors,
                               options.prior_scatter, options.least_mass_share);
    if (last == LastStep::AsItIs && iteration + 1 == options.max_iterations)
      break;
    const double before = posterior;
    current = expectation(run.mixture, points, options.computation);
    run.log_likelihoods.push_back(current.mean_log_likelihood);
    posterior = current.mean_log_likelihood + log_prior(run.mixture, points, options);
    if (posterior - before < options.tolerance)
      break;
  }
  return run;
}

}  // namespace

Mixture start_mixture(const BlockPoints& all_points, Eigen::Index components, std::uint64_t seed,
                      const EmOptions& options) {
  const BlockPoints points = thinned(all_points, kSamplePoints);
  const SimdKernels& kernels = *options.computation.kernels;
  const std::stop_token& stop = options.computation.stop;
  std::mt19937_64 generator(seed);
  const Eigen::MatrixXd centres =
      move_centres(points, choose_centres(points, components, kernels, generator, stop),
                   kLloydIterations, kernels, stop);
  return maximisation(
      moments_of_clusters(points, nearest_centres(points, centres, kernels, stop), centres.cols()),
      points.offset(), options.floors);
}

EmRun run_em(Mixture start, const BlockPoints& points, const EmOptions& options) {
  Expectation first = expectation(start, points, options.computation);
  return iterate(std::move(start), std::move(first), points, options, LastStep::Judged);
}

Mixture run_em_from(Mixture start, Expectation first, const BlockPoints& points,
                    const EmOptions& options) {
  return iterate(std::move(start), std::move(first), points, options, LastStep::AsItIs).mixture;
}

}  // namespace kinship::density
