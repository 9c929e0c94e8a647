#include "server/density/fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "server/density/block_points.hpp"
#include "server/density/distinct_points.hpp"
#include "server/density/em_run.hpp"
#include "server/density/fit_input.hpp"
#include "server/density/merge.hpp"
#include "server/density/parallel.hpp"
#include "server/density/prior_search.hpp"

namespace kinship::density {
namespace {

constexpr Eigen::Index kMaxTriedComponents = 128;  // where K is chosen

void check_options(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options) {
  check_sizes(configurations, weights, options.limits, "fit_mixture");
  if (options.components < 0 || !(options.covariance_floor >= 0) ||
      !std::isfinite(options.covariance_floor))
    throw std::invalid_argument(
        "fit_mixture: need components >= 0, a finite covariance_floor >= 0");
  if (options.prior != kChosenPrior && !(options.prior >= 0 && std::isfinite(options.prior)))
    throw std::invalid_argument("fit_mixture: need a finite prior >= 0, or kChosenPrior");
  if (options.max_iterations < 0 || std::isnan(options.tolerance))
    throw std::invalid_argument("fit_mixture: need max_iterations >= 0, a tolerance");
  const Eigen::VectorXd& floors = options.floors_of_joints;
  if (floors.size() != 0 &&
      (floors.size() != configurations.rows() || !floors.allFinite() || floors.minCoeff() < 0))
    throw std::invalid_argument("fit_mixture: need one finite floor >= 0 per joint");
  const std::optional<WarmStart>& warm = options.warm_start;
  if (warm && (warm->mixture.dimension() != configurations.rows() ||
               warm->is_new.size() != static_cast<std::size_t>(configurations.cols())))
    throw std::invalid_argument(
        "fit_mixture: need a mixture before of as many joints, and a flag per configuration");
  if (warm && !(warm->mixture.means().cwiseAbs().maxCoeff() <= 2 * kLargestValue))
    throw std::invalid_argument("fit_mixture: means of the mixture before exceed configurations");
  if (warm && warm->prior_scatter.size() > 0 &&
      (warm->prior_scatter.rows() != configurations.rows() ||
       warm->prior_scatter.cols() != configurations.rows() || !warm->prior_scatter.allFinite()))
    throw std::invalid_argument("fit_mixture: need a finite prior scatter of as many joints");
  if ((options.components == 0 || options.prior == kChosenPrior) && !warm &&
      !are_paths_of(options.path_of_configuration, configurations.cols()))
    throw std::invalid_argument(
        "fit_mixture: to choose K or a prior, the path of each configuration, counted from 0 "
        "without gaps");
}

EmOptions em_options(Eigen::Index dimension, const FitOptions& options) {
  return {options.floors_of_joints.size() > 0
              ? options.floors_of_joints
              : Eigen::VectorXd::Constant(dimension, options.covariance_floor),
          options.max_iterations, options.tolerance, options.computation,
          options.warm_start ? options.warm_start->prior_scatter : Eigen::MatrixXd{}};
}

/// The points that may have so many components: at least 2 (d + 1) each.
Eigen::Index components_for(const DistinctPoints& distinct, Eigen::Index dimension,
                            Eigen::Index wanted) {
  const auto count = static_cast<Eigen::Index>(distinct.columns.size());
  return std::clamp(count / (2 * (dimension + 1)), Eigen::Index{1}, wanted);
}

Eigen::Index sample_size(Eigen::Index components) {
  return std::max(kSamplePoints, kSamplePointsPerComponent * components);
}

bool is_large(const BlockPoints& points, Eigen::Index components) {
  return 2 * points.size() > 3 * sample_size(components);
}

/// All points, or a sample if they are many.
BlockPoints sample_of(BlockPoints points, Eigen::Index components) {
  return is_large(points, components) ? thinned(points, sample_size(components))
                                      : std::move(points);
}

/// The same for a part of the points that so much of their weight has.
EmOptions for_share(EmOptions em, double share) {
  em.prior_scatter *= share;
  return em;
}

double share_of(const BlockPoints& part, const BlockPoints& points) {
  return part.total_weight() / points.total_weight();
}

FitSummary summary_of(EmRun run, const EmOptions& em) {
  FitSummary summary{std::move(run.mixture), std::move(run.log_likelihoods)};
  summary.prior_scatter = em.prior_scatter;
  return summary;
}

FitSummary refined(Mixture start, const BlockPoints& points, EmOptions em) {
  if (is_large(points, start.size()))
    em.max_iterations = std::min(em.max_iterations, kFullPasses);
  return summary_of(run_em(std::move(start), points, em), em);
}

/// One fit on its way. The arguments outlive it.
class Fit {
 public:
  Fit(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
      const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options)
      : configurations_(configurations),
        data_(configurations, weights, options.path_of_configuration, options.computation.stop),
        options_(options),
        em_(em_options(configurations.rows(), options)) {}

  FitSummary run(DistinctPoints all) const {
    if (options_.warm_start)
      return run_warm(std::move(all), *options_.warm_start);
    if (options_.components > 0)
      return run_fixed(std::move(all), options_.components);
    auto split = data_.paths() < kMinPathsToScore
                     ? std::nullopt
                     : data_.split(held_out_paths(data_.paths(), options_.seed));
    if (!split)  // too little to hold a part of it out
      return run_fixed(std::move(all), components_of_few_paths(data_.paths()));
    return run_searched(std::move(all), std::move(*split));
  }

 private:
  struct Prior {
    double value = 0;
    std::optional<double> score = {};  // if it was chosen where paths are scored
  };

  FitSummary run_fixed(DistinctPoints all, int wanted) const {
    const Eigen::Index components = components_for(all, configurations_.rows(), wanted);
    std::optional<BlockPoints> blocks;
    auto [prior, start] = prior_and_start(wanted, [&] {
      blocks = data_.blocks_of(std::move(all));
      return start_mixture(*blocks, components, options_.seed, em_);
    });
    const BlockPoints& points = *blocks;
    const EmOptions em = with_prior(prior, start);
    if (is_large(points, components)) {
      const BlockPoints sample = thinned(points, sample_size(components));
      start = run_em(std::move(start), sample, for_share(em, share_of(sample, points))).mixture;
    }
    FitSummary summary = refined(std::move(start), points, em);
    summary.prior = prior.value;
    summary.held_out_score = prior.score;
    return summary;
  }

  /// With as many components as score best on the paths held out.
  FitSummary run_searched(DistinctPoints all, WeightedConfigurations::Split split) const {
    const Eigen::Index most =
        components_for(split.training, configurations_.rows(), kMaxTriedComponents);
    const BlockPoints training = data_.blocks_of(std::move(split.training));
    const BlockPoints sample = sample_of(training, most);
    auto [prior, start] = prior_and_start(
        kMaxTriedComponents, [&] { return start_mixture(sample, most, options_.seed, em_); });
    const EmOptions em = with_prior(prior, start);
    const ComponentSearch search = prune_components(
        std::move(start), sample, sample_of(data_.blocks_of(std::move(split.held_out)), most),
        log_uniform(configurations_, options_.limits), for_share(em, share_of(sample, training)));
    FitSummary summary = refined(search.best, data_.blocks_of(std::move(all)), em);
    summary.curve = search.curve;
    summary.held_out_score = search.best_score;
    summary.prior = prior.value;
    return summary;
  }

  /// Side by side: neither needs the other. \param wanted  components of a fit.
  template <typename MakeStart>
  std::pair<Prior, Mixture> prior_and_start(Eigen::Index wanted,
                                            const MakeStart& make_start) const {
    Prior prior;
    std::optional<Mixture> start;
    for_each_part(em_.computation.threads, 2, [&](int part) {
      if (part == 0)
        prior = find_prior(wanted);
      else
        start = make_start();
    });
    return {prior, *std::move(start)};
  }

  EmOptions with_prior(const Prior& prior, const Mixture& clusters) const {
    EmOptions em = em_;
    em.prior_scatter = prior_scatter(clusters, prior.value);
    return em;
  }

  Prior find_prior(Eigen::Index wanted) const {
    if (options_.prior != kChosenPrior)
      return {options_.prior};
    const std::vector<PriorFold> folds = prior_folds(wanted);
    if (folds.empty())
      return {kPriorOfOnePath};
    const PriorChoice choice =
        choose_prior(folds, log_uniform(configurations_, options_.limits), options_.seed, em_);
    if (data_.paths() < kMinPathsToScore)
      return {choice.prior};
    return {choice.prior, choice.score_of_first};
  }

  /// None if the first one has too little on either side: its score is told. No more of them than
  /// have half of kPriorPoints together.
  std::vector<PriorFold> prior_folds(Eigen::Index wanted) const {
    const auto parts = folds_of(data_.paths(), options_.seed);
    std::vector<PriorFold> folds;
    Eigen::Index points = 0;
    for (const std::vector<std::uint8_t>& held_out : parts) {
      if (points >= kPriorPoints / 2)
        break;
      auto split = data_.split(held_out);
      if (split) {
        folds.push_back(prior_fold(std::move(*split), wanted));
        points += folds.back().training.size();
      } else if (folds.empty() && data_.paths() >= kMinPathsToScore) {
        break;
      }
    }
    return folds;
  }

  PriorFold prior_fold(WeightedConfigurations::Split split, Eigen::Index wanted) const {
    const Eigen::Index components = components_for(split.training, configurations_.rows(), wanted);
    const BlockPoints all = data_.blocks_of(std::move(split.training));
    BlockPoints training = thinned(all, kPriorPoints);
    const double share = share_of(training, all);
    return {std::move(training), components, share,
            thinned(data_.blocks_of(std::move(split.held_out)), kPriorPoints / 4)};
  }

  /// With at most as many components as the configurations can carry. The mixture before is nearly
  /// there: new components settle on a sample, and all points are seen a few times only.
  FitSummary run_warm(DistinctPoints all, const WarmStart& warm) const {
    const Eigen::Index wanted = options_.components > 0 ? options_.components : warm.mixture.size();
    const Eigen::Index components = components_for(all, configurations_.rows(), wanted);
    Mixture start = with_components_for_new(configurations_, all, warm, options_.seed, em_);
    const BlockPoints points = data_.blocks_of(std::move(all));
    EmOptions few = em_;
    if (start.size() > components) {
      few.max_iterations = std::min(em_.max_iterations, kIterationsBeforeMerging);
      const BlockPoints sample = thinned(points, kWarmSamplePoints);
      const double share = share_of(sample, points);
      EmOptions settling = for_share(few, share);
      settling.least_mass_share = share;
      start = run_em(std::move(start), sample, settling).mixture;
      start = merged(start, components, em_.computation.stop);
    }
    few.max_iterations = points.size() > kWarmSamplePoints
                             ? std::min(em_.max_iterations, kWarmPasses)
                             : em_.max_iterations;
    return summary_of(run_em(std::move(start), points, few), few);
  }

  const Eigen::Ref<const Eigen::MatrixXd>& configurations_;
  const WeightedConfigurations data_;
  const FitOptions& options_;
  const EmOptions em_;
};

}  // namespace

int components_of_few_paths(std::uint32_t paths) {
  return std::max(1, static_cast<int>(paths / 4));
}

Result<FitSummary> fit_mixture(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const FitOptions& options) {
  check_options(configurations, weights, options);
  return estimate_of(configurations, weights, em_options(configurations.rows(), options).floors,
                     "fit", options.computation.stop, [&](DistinctPoints distinct) {
                       return Fit(configurations, weights, options).run(std::move(distinct));
                     });
}

}  // namespace kinship::density
