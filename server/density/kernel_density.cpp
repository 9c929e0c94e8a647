#include "server/density/kernel_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "proto/mixture/cholesky.hpp"
#include "proto/types/limits.hpp"
#include "server/density/block_points.hpp"
#include "server/density/component_search.hpp"
#include "server/density/em_run.hpp"
#include "server/density/fit_input.hpp"
#include "server/density/hold_out.hpp"

namespace kinship::density {
namespace {

constexpr std::array kClusters = {1, 4, 16, 64};
/// Falling by about the square root of 2.
constexpr std::array kScales = {2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.125, 0.09, 0.0625};
constexpr Eigen::Index kFoldPoints = 1000;  // of all folds together
constexpr double kLowClusterScore_nats =
    0.25;  // below the best of the clusters: narrower is no better

void check_options(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Ref<const Eigen::VectorXd>& weights,
                   const KernelDensityOptions& options) {
  check_sizes(configurations, weights, options.limits, "estimate_kernel_density");
  if (!are_paths_of(options.path_of_configuration, configurations.cols()))
    throw std::invalid_argument(
        "estimate_kernel_density: need the path of each configuration, counted from 0 without "
        "gaps");
  const Eigen::VectorXd& floors = options.floors_of_joints;
  if (floors.size() != configurations.rows() || !floors.allFinite() || floors.minCoeff() < 0)
    throw std::invalid_argument("estimate_kernel_density: need one finite floor >= 0 per joint");
}

/// Centres and weights of kernels.
struct Kernels {
  Eigen::MatrixXd centres;  // d x K
  Eigen::VectorXd weights;  // K, sum 1
};

Kernels all_of(const BlockPoints& points) {
  Kernels kernels{Eigen::MatrixXd(points.dimension(), points.size()),
                  Eigen::VectorXd(points.size())};
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    kernels.centres.col(i) = points.point(i) + points.offset();
    kernels.weights[i] = points.weight(i);
  }
  kernels.weights /= kernels.weights.sum();
  return kernels;
}

/// `count` draws in proportion to weight at even steps along the order of the blocks, in which
/// neighbours follow each other; a point drawn twice is one kernel of twice the weight.
Kernels sample_of(const BlockPoints& points, Eigen::Index count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const double step = points.total_weight() / static_cast<double>(count);
  double next = std::uniform_real_distribution<double>(0, step)(generator);
  Kernels kernels{Eigen::MatrixXd(points.dimension(), count), Eigen::VectorXd(count)};
  Eigen::Index size = 0;
  Eigen::Index drawn = 0;
  double passed = 0;
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    passed += points.weight(i);
    const bool is_last = i + 1 == points.size();
    int times = 0;
    for (; drawn < count && (next < passed || is_last); ++drawn, next += step)
      ++times;
    if (times == 0)
      continue;
    kernels.centres.col(size) = points.point(i) + points.offset();
    kernels.weights[size++] = static_cast<double>(times) / static_cast<double>(count);
  }
  kernels.centres.conservativeResize(Eigen::NoChange, size);
  kernels.weights.conservativeResize(size);
  return kernels;
}

Kernels kernels_of(const BlockPoints& points, std::uint64_t seed) {
  constexpr auto kMaxCount = static_cast<Eigen::Index>(kMaxKernels);
  return points.size() > kMaxCount ? sample_of(points, kMaxCount, seed) : all_of(points);
}

/// The mean covariance of clusters of points.
Eigen::MatrixXd pooled_covariance(const BlockPoints& points, int clusters, std::uint64_t seed,
                                  const Computation& computation) {
  const EmOptions no_floor{.floors = Eigen::VectorXd::Zero(points.dimension()),
                           .computation = computation};
  const Mixture mixture = start_mixture(points, clusters, seed, no_floor);
  Eigen::MatrixXd pooled = Eigen::MatrixXd::Zero(points.dimension(), points.dimension());
  for (Eigen::Index k = 0; k < mixture.size(); ++k)
    pooled += mixture.weights()[k] * mixture.covariance(k);
  return pooled;
}

Mixture mixture_of(const Kernels& kernels, const Eigen::MatrixXd& pooled, double scale,
                   const Eigen::VectorXd& floors) {
  Eigen::MatrixXd covariance = scale * scale * pooled;
  covariance.diagonal() += floors;
  return {kernels.weights, kernels.centres, {std::move(covariance)}};
}

/// A number to be kept in half the bytes: the nearest f32, or, where that lies beyond a limit that
/// the number keeps, the next one on this side of it. Where no f32 lies within the limits the
/// nearest one stands.
/// \param lower, upper  or infinite; a number outside them is only rounded.
float rounded_inward(double number, double lower, double upper) noexcept {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(number);
  if (number <= upper && static_cast<double>(nearest) > upper) {
    const float below = std::nextafter(nearest, -kInfinity);
    return static_cast<double>(below) < lower ? nearest : below;
  }
  if (number >= lower && static_cast<double>(nearest) < lower) {
    const float above = std::nextafter(nearest, kInfinity);
    return static_cast<double>(above) > upper ? nearest : above;
  }
  return nearest;
}

/// Rounded to f32; values within limits stay there.
void round_inward(Eigen::MatrixXd& centres, const Eigen::Matrix2Xd& limits) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool has_limits = limits.size() > 0;
  for (Eigen::Index joint = 0; joint < centres.rows(); ++joint) {
    const double lower = has_limits ? limits(0, joint) : -kInfinity;
    const double upper = has_limits ? limits(1, joint) : kInfinity;
    for (double& value : centres.row(joint))
      value = rounded_inward(value, lower, upper);
  }
}

/// One estimate on its way. The arguments outlive it.
class Estimate {
 public:
  Estimate(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
           const Eigen::Ref<const Eigen::VectorXd>& weights, const KernelDensityOptions& options)
      : dimension_(configurations.rows()),
        data_(configurations, weights, options.path_of_configuration, options.computation.stop),
        options_(options),
        log_uniform_(log_uniform(configurations, options.limits)) {}

  KernelDensity run(DistinctPoints all) const {
    const Choice choice = choose(folds());
    const BlockPoints points = data_.blocks_of(std::move(all));
    const Eigen::MatrixXd pooled =
        pooled_covariance(points, choice.bandwidth.clusters, options_.seed, options_.computation);
    Kernels kernels = kernels_of(points, options_.seed);
    round_inward(kernels.centres, options_.limits);
    KernelDensity estimate{
        mixture_of(kernels, pooled, choice.bandwidth.scale, options_.floors_of_joints),
        choice.bandwidth};
    mixture::cholesky_factors(estimate.mixture);  // throws if there is none
    if (data_.paths() >= kMinPathsToScore)
      estimate.held_out_score = choice.score_of_first;
    return estimate;
  }

 private:
  /// Kernels of some paths, and points of others that score them.
  struct Fold {
    BlockPoints training;
    Kernels kernels;
    BlockPoints held_out;
  };
  struct Choice {
    Bandwidth bandwidth;
    std::optional<double> score = {};           // the mean over the folds
    std::optional<double> score_of_first = {};  // of them
  };

  std::vector<Fold> folds() const {
    const std::uint32_t paths = data_.paths();
    const std::vector<std::vector<std::uint8_t>> parts = folds_of(paths, options_.seed);
    std::vector<Fold> folds;
    for (const std::vector<std::uint8_t>& held_out : parts) {
      add_fold(held_out, kFoldPoints / static_cast<Eigen::Index>(parts.size()), folds);
      if (folds.empty() && paths >= kMinPathsToScore)
        break;  // the score that is told is that of the first
    }
    return folds;
  }

  /// Unless there is too little on either side.
  void add_fold(const std::vector<std::uint8_t>& held_out, Eigen::Index most_scored,
                std::vector<Fold>& folds) const {
    auto split = data_.split(held_out);
    if (!split)
      return;
    BlockPoints points = data_.blocks_of(std::move(split->training));
    Kernels kernels = kernels_of(points, options_.seed);
    folds.push_back({std::move(points), std::move(kernels),
                     thinned(data_.blocks_of(std::move(split->held_out)), most_scored)});
  }

  Choice choose(const std::vector<Fold>& folds) const {
    Choice best{{1, scale_of_one_path(dimension_)}};
    for (const int clusters : kClusters) {
      if (folds.empty() || !can_have(folds, clusters))
        break;
      std::vector<Eigen::MatrixXd> pooled;
      for (const Fold& fold : folds)
        pooled.push_back(
            pooled_covariance(fold.training, clusters, options_.seed, options_.computation));
      double best_of_clusters = -std::numeric_limits<double>::infinity();
      for (const double scale : kScales) {
        const std::vector<double> scores = scores_of(folds, pooled, scale);
        const double score =
            std::accumulate(scores.begin(), scores.end(), 0.0) / static_cast<double>(scores.size());
        if (!best.score || score > *best.score)
          best = {{clusters, scale}, score, scores.front()};
        best_of_clusters = std::max(best_of_clusters, score);
        if (score < best_of_clusters - kLowClusterScore_nats)
          break;
      }
    }
    return best;
  }

  /// Whether each cluster of each training part can have 2 (d + 1) points.
  bool can_have(const std::vector<Fold>& folds, int clusters) const {
    const Eigen::Index least = clusters == 1 ? 1 : 2 * (dimension_ + 1) * clusters;
    return std::all_of(folds.begin(), folds.end(),
                       [&](const Fold& fold) { return fold.training.size() >= least; });
  }

  /// Of each fold.
  std::vector<double> scores_of(const std::vector<Fold>& folds,
                                const std::vector<Eigen::MatrixXd>& pooled, double scale) const {
    std::vector<double> scores;
    for (std::size_t i = 0; i < folds.size(); ++i)
      scores.push_back(mean_log_density(
          mixture_of(folds[i].kernels, pooled[i], scale, options_.floors_of_joints),
          folds[i].held_out, kBackgroundShare, log_uniform_, options_.computation));
    return scores;
  }

  const Eigen::Index dimension_;
  const WeightedConfigurations data_;
  const KernelDensityOptions& options_;
  const double log_uniform_;
};

}  // namespace

double scale_of_one_path(Eigen::Index dimension) {
  const auto d = static_cast<double>(dimension);
  return std::pow(4 / (d + 2), 1 / (d + 4));
}

Result<KernelDensity> estimate_kernel_density(
    const Eigen::Ref<const Eigen::MatrixXd>& configurations,
    const Eigen::Ref<const Eigen::VectorXd>& weights, const KernelDensityOptions& options) {
  check_options(configurations, weights, options);
  return estimate_of(configurations, weights, options.floors_of_joints, "kernels",
                     options.computation.stop, [&](DistinctPoints distinct) {
                       return Estimate(configurations, weights, options).run(std::move(distinct));
                     });
}

}  // namespace kinship::density
