#include "server/density/prior_search.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "proto/types/failure.hpp"
#include "server/density/component_search.hpp"
#include "server/density/parallel.hpp"

namespace kinship::density {
namespace {

constexpr std::array kPriors = {160.0, 80.0, 40.0, 20.0, 10.0, 5.0, 2.5, 0.0};
constexpr int kFirst = 2;  // of them: near what most sets of recorded paths prefer
constexpr int kIterationsPerPrior = 3;
constexpr int kIterationsPerPriorOfFew = 5;  // where there are several folds: they cost little
constexpr int kMostTogether = 4;             // priors: one of them too many is work for nothing

constexpr bool is_prior(int i) { return i >= 0 && i < static_cast<int>(kPriors.size()); }

/// How well the folds are described with a prior.
class PriorScores {
 public:
  /// The arguments outlive it.
  PriorScores(const std::vector<PriorFold>& folds, double log_uniform, std::uint64_t seed,
              const EmOptions& options)
      : folds_(folds), log_uniform_(log_uniform), step_(options) {
    for (const PriorFold& fold : folds) {
      starts_.push_back(start_mixture(fold.training, fold.components, seed, options));
      units_.push_back(prior_scatter(starts_.back(), fold.share));
      try {
        firsts_.push_back(expectation(starts_.back(), fold.training, options.computation));
      } catch (const Failure&) {  // a covariance is too narrow beside its floor to be factored
        break;
      }
    }
    step_.max_iterations = std::min(
        options.max_iterations, folds.size() > 1 ? kIterationsPerPriorOfFew : kIterationsPerPrior);
  }

  /// Whether any prior can be tried.
  bool can_begin() const noexcept { return firsts_.size() == folds_.size(); }

  /// The sum of the folds' scores with a prior; none where a covariance is too narrow beside its
  /// floor to be factored, as it is with a weaker prior then.
  /// \param towards  where the search goes, 1 or -1: priors there are tried together with this one,
  ///                 each by its share of the threads. Their fits are so small that threads of one
  ///                 would wait for each other most of the time.
  std::optional<double> sum(int prior, int towards) {
    if (!scores_[at(prior)])
      try_together(prior, towards);
    const std::vector<double>& scores = *scores_[at(prior)];
    if (scores.empty())
      return std::nullopt;
    return std::accumulate(scores.begin(), scores.end(), 0.0);
  }

  /// \param prior  whose sum() was asked for.
  double score_of_first(int prior) const { return scores_[at(prior)]->front(); }

 private:
  static std::size_t at(int prior) { return static_cast<std::size_t>(prior); }

  void try_together(int prior, int towards) {
    std::vector<int> priors;
    const auto most =
        static_cast<std::size_t>(std::clamp(step_.computation.threads, 1, kMostTogether));
    for (int i = prior; is_prior(i) && priors.size() < most && !scores_[at(i)]; i += towards)
      priors.push_back(i);
    const auto count = static_cast<int>(priors.size());
    for_each_part(count, count, [&](int i) {
      const int one = priors[at(i)];
      try {
        scores_[at(one)] = scores_of(kPriors[at(one)], step_.computation.threads / count);
      } catch (const Failure&) {
        scores_[at(one)].emplace();
      }
    });
  }

  std::vector<double> scores_of(double prior, int threads) const {
    EmOptions step = step_;
    step.computation.threads = std::max(threads, 1);
    std::vector<double> scores;
    for (std::size_t i = 0; i < folds_.size(); ++i) {
      step.prior_scatter = prior * units_[i];
      const Mixture mixture = run_em_from(starts_[i], firsts_[i], folds_[i].training, step);
      scores.push_back(mean_log_density(mixture, folds_[i].held_out, kBackgroundShare, log_uniform_,
                                        step.computation));
    }
    return scores;
  }

  const std::vector<PriorFold>& folds_;
  const double log_uniform_;
  EmOptions step_;
  std::vector<Mixture> starts_;
  std::vector<Expectation> firsts_;     // of the starts
  std::vector<Eigen::MatrixXd> units_;  // the scatter of a prior of 1
  std::array<std::optional<std::vector<double>>, kPriors.size()>
      scores_;  // per fold; empty: failed
};

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
  PriorScores scores(folds, log_uniform, seed, options);
  if (!scores.can_begin())
    return {};
  std::optional<double> best_sum;
  int best = kFirst;
  for (int i = kFirst, towards = 1; is_prior(i); i += towards) {
    const auto sum = scores.sum(i, towards);
    if (sum && (!best_sum || *sum > *best_sum)) {
      best_sum = sum;
      best = i;
    } else if (towards == 1 && best == kFirst) {  // no weaker one is better
      towards = -1;
      i = kFirst;
    } else if (best_sum) {
      break;
    }
  }
  if (!best_sum)
    return {};
  return {kPriors[static_cast<std::size_t>(best)], scores.score_of_first(best)};
}

}  // namespace kinship::density
