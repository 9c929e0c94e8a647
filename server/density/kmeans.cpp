#include "server/density/kmeans.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinship::density {
namespace {

/// Squared distances to the nearest centre if `centre` joins those behind `distances`.
Eigen::ArrayXd distances_with(const Eigen::MatrixXd& transposed, Eigen::Index centre,
                              const Eigen::ArrayXd& distances) {
  Eigen::ArrayXd squared = Eigen::ArrayXd::Zero(transposed.rows());
  for (Eigen::Index joint = 0; joint < transposed.cols(); ++joint)
    squared += (transposed.col(joint).array() - transposed(centre, joint)).square();
  return squared.min(distances);
}

/// An index with probability proportional to its mass.
Eigen::Index draw_index(const Eigen::ArrayXd& masses, double total, std::mt19937_64& generator) {
  double remaining = std::uniform_real_distribution<double>(0, total)(generator);
  Eigen::Index last = 0;
  for (Eigen::Index i = 0; i < masses.size(); ++i) {
    if (masses[i] <= 0)
      continue;
    last = i;
    remaining -= masses[i];
    if (remaining < 0)
      break;
  }
  return last;
}

}  // namespace

Eigen::MatrixXd choose_centres(const Eigen::Ref<const Eigen::MatrixXd>& points,
                               const Eigen::Ref<const Eigen::VectorXd>& weights, Eigen::Index count,
                               std::mt19937_64& generator) {
  const Eigen::MatrixXd transposed = points.transpose();  // n x d: columns to vectorise over
  const int tries = 2 + static_cast<int>(std::log(static_cast<double>(count)));
  Eigen::MatrixXd centres(points.rows(), count);
  const Eigen::Index first = draw_index(weights.array(), weights.sum(), generator);
  centres.col(0) = points.col(first);
  Eigen::ArrayXd distances = distances_with(
      transposed, first,
      Eigen::ArrayXd::Constant(points.cols(), std::numeric_limits<double>::infinity()));
  for (Eigen::Index chosen = 1; chosen < count; ++chosen) {
    const Eigen::ArrayXd masses = weights.array() * distances;
    const double total = masses.sum();
    if (!(total > 0))
      return centres.leftCols(chosen);  // every point is a centre already
    double best_total = std::numeric_limits<double>::infinity();
    Eigen::ArrayXd best_distances;
    for (int attempt = 0; attempt < tries; ++attempt) {
      const Eigen::Index candidate = draw_index(masses, total, generator);
      Eigen::ArrayXd with_candidate = distances_with(transposed, candidate, distances);
      const double candidate_total = (weights.array() * with_candidate).sum();
      if (candidate_total >= best_total)
        continue;
      best_total = candidate_total;
      centres.col(chosen) = points.col(candidate);
      best_distances.swap(with_candidate);
    }
    distances.swap(best_distances);
  }
  return centres;
}

std::vector<Eigen::Index> nearest_centres(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                          const Eigen::Ref<const Eigen::MatrixXd>& centres) {
  constexpr Eigen::Index kBlock = 256;
  std::vector<Eigen::Index> nearest(static_cast<std::size_t>(points.cols()), 0);
  const Eigen::VectorXd half_norms = 0.5 * centres.colwise().squaredNorm().transpose();
  Eigen::MatrixXd scores;  // n x K: point . centre - |centre|^2 / 2 grows as the distance falls
  for (Eigen::Index begin = 0; begin < points.cols(); begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, points.cols() - begin);
    scores.noalias() = points.middleCols(begin, count).transpose() * centres;
    scores.rowwise() -= half_norms.transpose();
    for (Eigen::Index k = 1; k < centres.cols(); ++k)
      for (Eigen::Index i = 0; i < count; ++i) {
        if (scores(i, k) <= scores(i, 0))
          continue;
        scores(i, 0) = scores(i, k);  // column 0 keeps the best so far
        nearest[static_cast<std::size_t>(begin + i)] = k;
      }
  }
  return nearest;
}

Eigen::MatrixXd move_centres(const Eigen::Ref<const Eigen::MatrixXd>& points,
                             const Eigen::Ref<const Eigen::VectorXd>& weights,
                             Eigen::MatrixXd centres, int max_iterations) {
  std::vector<Eigen::Index> previous;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::vector<Eigen::Index> nearest = nearest_centres(points, centres);
    if (nearest == previous)
      break;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centres.rows(), centres.cols());
    Eigen::VectorXd masses = Eigen::VectorXd::Zero(centres.cols());
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Eigen::Index k = nearest[static_cast<std::size_t>(i)];
      sums.col(k) += weights[i] * points.col(i);
      masses[k] += weights[i];
    }
    for (Eigen::Index k = 0; k < centres.cols(); ++k)
      if (masses[k] > 0)
        centres.col(k) = sums.col(k) / masses[k];
    previous = std::move(nearest);
  }
  return centres;
}

}  // namespace kinship::density
