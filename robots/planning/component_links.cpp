#include "robots/planning/component_links.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "proto/mixture/cholesky.hpp"
#include "robots/planning/guidance_gate.hpp"

namespace kinship::planning {
namespace {

constexpr double kClose = 1;  // Bhattacharyya distance

double half_log_determinant(const Eigen::MatrixXd& factor) {
  return factor.diagonal().array().log().sum();
}

}  // namespace

ComponentShapes::ComponentShapes(const ConfigurationSampler& sampler)
    : means_(sampler.mixture()->means()),
      covariances_(sampler.mixture()->covariances()),
      factors_(mixture::cholesky_factors(*sampler.mixture())),
      widened_factors_(mixture::cholesky_factors(widened(*sampler.mixture()))) {
  for (Eigen::Index k = 0; k < means_.cols(); ++k)
    if (const auto moved = sampler.moved_into_bounds(means_.col(k)))
      means_.col(k) = *moved;
}

double ComponentShapes::doubt(Eigen::Index k, const Eigen::VectorXd& q) const {
  Eigen::VectorXd offset = q - means_.col(k);
  widened_factors_[index(k)].triangularView<Eigen::Lower>().solveInPlace(offset);
  return offset.squaredNorm() / static_cast<double>(offset.size());
}

double ComponentShapes::min_doubt(const Eigen::VectorXd& q) const {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < size(); ++k)
    least = std::min(least, doubt(k, q));
  return least;
}

// Kailath, The Divergence and Bhattacharyya Distance Measures in Signal Selection (1967).
double ComponentShapes::bhattacharyya_distance(Eigen::Index i, Eigen::Index j) const {
  const std::size_t first = index(i), second = index(j);
  const Eigen::MatrixXd factor = ((covariances_[first] + covariances_[second]) / 2).llt().matrixL();
  Eigen::VectorXd offset = means_.col(i) - means_.col(j);
  factor.triangularView<Eigen::Lower>().solveInPlace(offset);
  return offset.squaredNorm() / 8 + half_log_determinant(factor) -
         (half_log_determinant(factors_[first]) + half_log_determinant(factors_[second])) / 2;
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> ComponentShapes::links(int neighbours) const {
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(size(), size());
  for (Eigen::Index i = 0; i < size(); ++i)
    for (Eigen::Index j = i + 1; j < size(); ++j)
      distances(i, j) = distances(j, i) = bhattacharyya_distance(i, j);
  std::set<std::pair<Eigen::Index, Eigen::Index>> close;
  std::vector<Eigen::Index> others(static_cast<std::size_t>(size()));
  for (Eigen::Index i = 0; i < size(); ++i) {
    std::iota(others.begin(), others.end(), Eigen::Index{0});
    others.erase(others.begin() + i);
    std::stable_sort(others.begin(), others.end(), [&](Eigen::Index a, Eigen::Index b) {
      return distances(a, i) < distances(b, i);
    });
    int rank = 0;
    for (const Eigen::Index j : others)
      if (rank++ < neighbours || distances(j, i) <= kClose)
        close.emplace(std::min(i, j), std::max(i, j));
    others.push_back(0);
  }
  return {close.begin(), close.end()};
}

}  // namespace kinship::planning
