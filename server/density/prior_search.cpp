#include "server/density/prior_search.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "proto/types/failure.hpp"
#include "server/density/component_search.hpp"

namespace kinship::density {
namespace {

constexpr std::array kPriors = {160.0, 80.0, 40.0, 20.0, 10.0, 5.0, 2.5, 0.0};
constexpr int kIterationsPerPrior = 5;

}  // namespace

Eigen::MatrixXd prior_scatter(const Mixture& clusters, double prior) {
  if (prior == 0)
    return {};
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(clusters.dimension(), clusters.dimension());
  for (Eigen::Index k = 0; k < clusters.size(); ++k)
    scatter += clusters.weights()[k] * clusters.covariance(k);
  return prior * scatter;
}

PriorChoice choose_prior(const std::vector<PriorFold>& folds, double log_uniform,
                         std::uint64_t seed, const EmOptions& options) {
  std::vector<Mixture> starts;
  std::vector<Eigen::MatrixXd> units;  // the scatter of a prior of 1
  for (const PriorFold& fold : folds) {
    starts.push_back(start_mixture(fold.training, fold.components, seed, options));
    units.push_back(prior_scatter(starts.back(), fold.share));
  }
  EmOptions step = options;
  step.max_iterations = std::min(options.max_iterations, kIterationsPerPrior);
  PriorChoice best;
  double best_sum = -std::numeric_limits<double>::infinity();
  for (const double prior : kPriors) {
    std::vector<double> scores;
    try {
      for (std::size_t i = 0; i < folds.size(); ++i) {
        step.prior_scatter = prior * units[i];
        const Mixture mixture = run_em(starts[i], folds[i].training, step).mixture;
        scores.push_back(mean_log_density(mixture, folds[i].held_out, kBackgroundShare, log_uniform,
                                          options.computation));
      }
    } catch (const Failure&) {
      break;  // too narrow beside its floor to be factored, as with a weaker prior
    }
    const double sum = std::accumulate(scores.begin(), scores.end(), 0.0);
    if (sum <= best_sum)
      break;
    best_sum = sum;
    best = {prior, scores.front()};
  }
  return best;
}

}  // namespace kinship::density
