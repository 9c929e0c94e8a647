#include "server/density/warm_start.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "proto/mixture/density.hpp"
#include "server/density/distinct_points.hpp"

namespace kinship::density {
namespace {

constexpr double kPoorQuantile = 0.01;
constexpr std::size_t kScoredPoints = 5000;  // of the old ones, and of the new ones

/// The points that are new, or those that are not.
DistinctPoints part_of(const DistinctPoints& points, const std::vector<std::uint8_t>& is_new,
                       bool of_new) {
  DistinctPoints part;
  for (std::size_t i = 0; i < points.columns.size(); ++i)
    if ((is_new[points.columns[i]] != 0) == of_new) {
      part.columns.push_back(points.columns[i]);
      part.weights.push_back(points.weights[i]);
    }
  return part;
}

double total_weight(const DistinctPoints& points) {
  return std::accumulate(points.weights.begin(), points.weights.end(), 0.0);
}

/// At most kScoredPoints of the points, one of every so many in their order.
DistinctPoints sample_of(const DistinctPoints& points) {
  const std::size_t size = points.columns.size();
  if (size <= kScoredPoints)
    return points;
  DistinctPoints sample;
  for (std::size_t i = 0; i < kScoredPoints; ++i) {
    const std::size_t index = i * size / kScoredPoints;
    sample.columns.push_back(points.columns[index]);
    sample.weights.push_back(points.weights[index]);
  }
  return sample;
}

/// Finite: where rounding leaves no density it is the least number.
Eigen::VectorXd scores_of(const Mixture& mixture, const DistinctPoints& points,
                          const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  Eigen::MatrixXd columns(configurations.rows(), static_cast<Eigen::Index>(points.columns.size()));
  for (Eigen::Index i = 0; i < columns.cols(); ++i)
    columns.col(i) = configurations.col(points.columns[static_cast<std::size_t>(i)]);
  return mixture::log_density(mixture, columns).unaryExpr([](double score) {
    return std::isfinite(score) ? score : std::numeric_limits<double>::lowest();
  });
}

/// The score that so much of the weight lies below.
double quantile(const Eigen::VectorXd& scores, const std::vector<double>& weights, double share) {
  std::vector<std::size_t> order(weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto score = [&scores](std::size_t i) { return scores[static_cast<Eigen::Index>(i)]; };
  std::sort(order.begin(), order.end(),
            [&score](std::size_t a, std::size_t b) { return score(a) < score(b); });
  double left = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  for (const std::size_t i : order)
    if ((left -= weights[i]) <= 0)
      return score(i);
  return score(order.back());
}

/// Those below a score.
DistinctPoints poor_of(const DistinctPoints& points, const Eigen::VectorXd& scores, double limit) {
  DistinctPoints poor;
  for (std::size_t i = 0; i < points.columns.size(); ++i)
    if (scores[static_cast<Eigen::Index>(i)] < limit) {
      poor.columns.push_back(points.columns[i]);
      poor.weights.push_back(points.weights[i]);
    }
  return poor;
}

/// Both mixtures; the second has so much of the weight.
Mixture joined(const Mixture& first, const Mixture& second, double share) {
  Eigen::VectorXd weights(first.size() + second.size());
  weights << (1 - share) * first.weights(), share * second.weights();
  Eigen::MatrixXd means(first.dimension(), weights.size());
  means << first.means(), second.means();
  std::vector<Eigen::MatrixXd> covariances;
  for (const Mixture* part : {&first, &second})  // kernels share one
    for (Eigen::Index k = 0; k < part->size(); ++k)
      covariances.push_back(part->covariance(k));
  return {weights / weights.sum(), std::move(means), std::move(covariances)};
}

}  // namespace

Mixture with_components_for_new(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                const DistinctPoints& points, const WarmStart& warm,
                                std::uint64_t seed, const EmOptions& options) {
  const DistinctPoints all_new = part_of(points, warm.is_new, true);
  const DistinctPoints old_ones = sample_of(part_of(points, warm.is_new, false));
  const DistinctPoints new_ones = sample_of(all_new);
  if (old_ones.columns.empty() || new_ones.columns.empty())
    return warm.mixture;
  const double limit =
      quantile(scores_of(warm.mixture, old_ones, configurations), old_ones.weights, kPoorQuantile);
  DistinctPoints poor = poor_of(new_ones, scores_of(warm.mixture, new_ones, configurations), limit);
  const auto count = static_cast<Eigen::Index>(poor.columns.size());
  const Eigen::Index clusters =
      std::min(count / (2 * (configurations.rows() + 1)), kMostNewComponents);
  if (clusters == 0)
    return warm.mixture;

  const double share =
      total_weight(all_new) / total_weight(points) * total_weight(poor) / total_weight(new_ones);
  const double average = total_weight(poor) / static_cast<double>(count);
  for (double& weight : poor.weights)
    weight /= average;  // as clusters are left out by their number of average points
  const Eigen::VectorXd mean = mean_of(configurations, poor);
  const BlockPoints poor_points(configurations, std::move(poor), mean);
  return joined(warm.mixture, start_mixture(poor_points, clusters, seed, options), share);
}

}  // namespace kinship::density
