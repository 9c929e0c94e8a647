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
  if (options.components == 0 && !warm &&
      !are_paths_of(options.path_of_configuration, configurations.cols()))
    throw std::invalid_argument(
        "fit_mixture: to choose K, the path of each configuration, counted from 0 without gaps");
}

EmOptions em_options(Eigen::Index dimension, const FitOptions& options) {
  return {options.floors_of_joints.size() > 0
              ? options.floors_of_joints
              : Eigen::VectorXd::Constant(dimension, options.covariance_floor),
          options.max_iterations, options.tolerance, options.computation};
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
  return points.size() > 4 * sample_size(components);
}

/// All points, or a sample if they are many.
BlockPoints sample_of(BlockPoints points, Eigen::Index components) {
  return is_large(points, components) ? thinned(points, sample_size(components))
                                      : std::move(points);
}

FitSummary refined(Mixture start, const BlockPoints& points, EmOptions em) {
  if (is_large(points, start.size()))
    em.max_iterations = std::min(em.max_iterations, kFullPasses);
  EmRun run = run_em(std::move(start), points, em);
  return {std::move(run.mixture), std::move(run.log_likelihoods)};
}

/// One fit on its way. The arguments outlive it.
class Fit {
 public:
  Fit(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
      const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options)
      : configurations_(configurations),
        data_(configurations, weights, options.path_of_configuration),
        options_(options),
        em_(em_options(configurations.rows(), options)) {}

  FitSummary run(DistinctPoints all) const {
    if (options_.warm_start)
      return run_warm(std::move(all), *options_.warm_start);
    if (options_.components > 0)
      return run_fixed(std::move(all), options_.components);
    const std::optional<ComponentSearch> search = search_components();
    if (!search)
      return run_fixed(std::move(all), components_of_few_paths(data_.paths()));
    FitSummary summary = refined(search->best, data_.blocks_of(std::move(all)), em_);
    summary.curve = search->curve;
    summary.held_out_score = search->best_score;
    return summary;
  }

 private:
  FitSummary run_fixed(DistinctPoints all, int wanted) const {
    const Eigen::Index components = components_for(all, configurations_.rows(), wanted);
    const BlockPoints points = data_.blocks_of(std::move(all));
    Mixture start = start_mixture(points, components, options_.seed, em_);
    if (is_large(points, components))
      start = run_em(std::move(start), sample_of(points, components), em_).mixture;
    return refined(std::move(start), points, em_);
  }

  /// With at most as many components as the configurations can carry. The mixture before is nearly
  /// there: what joins it settles on a sample, and all points are seen a few times only.
  FitSummary run_warm(DistinctPoints all, const WarmStart& warm) const {
    const Eigen::Index wanted = options_.components > 0 ? options_.components : warm.mixture.size();
    const Eigen::Index components = components_for(all, configurations_.rows(), wanted);
    Mixture start = with_components_for_new(configurations_, all, warm, options_.seed, em_);
    const BlockPoints points = data_.blocks_of(std::move(all));
    EmOptions few = em_;
    if (start.size() > components) {
      few.max_iterations = std::min(em_.max_iterations, kIterationsBeforeMerging);
      start = run_em(std::move(start), thinned(points, sample_size(components)), few).mixture;
      start = merged(start, components);
    }
    few.max_iterations = points.size() > sample_size(components)
                             ? std::min(em_.max_iterations, kWarmPasses)
                             : em_.max_iterations;
    EmRun run = run_em(std::move(start), points, few);
    return {std::move(run.mixture), std::move(run.log_likelihoods)};
  }

  /// \return nothing if there is too little to hold a part of it out.
  std::optional<ComponentSearch> search_components() const {
    if (data_.paths() < kMinPathsToScore)
      return std::nullopt;
    auto split = data_.split(held_out_paths(data_.paths(), options_.seed));
    if (!split)
      return std::nullopt;
    const Eigen::Index most =
        components_for(split->training, configurations_.rows(), kMaxTriedComponents);
    return prune_components(sample_of(data_.blocks_of(std::move(split->training)), most),
                            sample_of(data_.blocks_of(std::move(split->held_out)), most), most,
                            log_uniform(configurations_, options_.limits), options_.seed, em_);
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
                     "fit", [&](DistinctPoints distinct) {
                       return Fit(configurations, weights, options).run(std::move(distinct));
                     });
}

}  // namespace kinship::density
