#include "server/density/warm_start.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "server/density/distinct_points.hpp"

namespace kinship::density {
namespace {

constexpr double kPoorQuantile = 0.01;
constexpr std::size_t kScoredPoints = 5000;  // of the old ones, and of the new ones

/// The points that are new, or the others.
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

BlockPoints blocks_of(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                      DistinctPoints points) {
  const Eigen::VectorXd mean = mean_of(configurations, points);
  return {configurations, std::move(points), mean};
}

/// The score that so much of the points' weight lies below.
double quantile(const Eigen::VectorXd& scores, const BlockPoints& points, double share) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(scores.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&scores](Eigen::Index a, Eigen::Index b) { return scores[a] < scores[b]; });
  double left = share * points.total_weight();
  for (const Eigen::Index i : order)
    if ((left -= points.weight(i)) <= 0)
      return scores[i];
  return scores[order.back()];
}

/// Some of the points, and the weight of all of them.
struct Poor {
  Eigen::MatrixXd configurations;
  DistinctPoints points;  // of these configurations
  double weight = 0;
};

/// The points below a score.
Poor poor_of(const BlockPoints& points, const Eigen::VectorXd& scores, double limit) {
  Poor poor{Eigen::MatrixXd(points.dimension(), points.size()), {}};
  std::uint32_t count = 0;
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    if (scores[i] >= limit)
      continue;
    poor.configurations.col(count) = points.point(i) + points.offset();
    poor.points.columns.push_back(count++);
    poor.points.weights.push_back(points.weight(i));
  }
  poor.weight = total_weight(poor.points);
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
  const BlockPoints scored = blocks_of(configurations, old_ones);
  const double limit =
      quantile(log_densities(warm.mixture, scored, options.computation), scored, kPoorQuantile);
  const BlockPoints added = blocks_of(configurations, new_ones);
  Poor poor = poor_of(added, log_densities(warm.mixture, added, options.computation), limit);
  const auto count = static_cast<Eigen::Index>(poor.points.columns.size());
  const Eigen::Index clusters =
      std::min(count / (2 * (configurations.rows() + 1)), kMaxNewComponents);
  if (clusters == 0)
    return warm.mixture;

  const double share =
      total_weight(all_new) / total_weight(points) * poor.weight / added.total_weight();
  const double average = poor.weight / static_cast<double>(count);
  for (double& weight : poor.points.weights)
    weight /= average;  // as clusters are left out by their number of average points
  const BlockPoints poor_points = blocks_of(poor.configurations, std::move(poor.points));
  return joined(warm.mixture, start_mixture(poor_points, clusters, seed, options), share);
}

}  // namespace kinship::density
