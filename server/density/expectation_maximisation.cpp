#include "server/density/expectation_maximisation.hpp"

#include <algorithm>

#include "proto/mixture/component_densities.hpp"
#include "server/density/responsibilities.hpp"

namespace kinship::density {
namespace {

constexpr Eigen::Index kBlock = 256;  // points whose responsibilities stay in the cache

/// All sums at once: one matrix product with the features 1, q_i, q_i q_j of each point.
class MomentSums {
 public:
  MomentSums(Eigen::Index dimension, Eigen::Index components)
      : dimension_(dimension),
        sums_(Eigen::MatrixXd::Zero(1 + dimension + dimension * (dimension + 1) / 2, components)) {}

  /// \param points   d x n.
  /// \param masses   n x K, responsibility times point weight.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& points,
           const Eigen::Ref<const Eigen::MatrixXd>& masses) {
    features_.resize(points.cols(), sums_.rows());
    features_.col(0).setOnes();
    features_.middleCols(1, dimension_) = points.transpose();
    Eigen::Index column = 1 + dimension_;
    for (Eigen::Index i = 0; i < dimension_; ++i)
      for (Eigen::Index j = i; j < dimension_; ++j)
        features_.col(column++) = features_.col(1 + i).cwiseProduct(features_.col(1 + j));
    sums_.noalias() += features_.transpose() * masses;
  }

  Moments moments() const {
    return {sums_.row(0).transpose(), sums_.middleRows(1, dimension_),
            sums_.bottomRows(dimension_ * (dimension_ + 1) / 2)};
  }

 private:
  Eigen::Index dimension_;
  Eigen::MatrixXd sums_;      // features x K
  Eigen::MatrixXd features_;  // n x features
};

}  // namespace

Expectation expectation(const Mixture& mixture, const WeightedPoints& points) {
  const mixture::ComponentDensities components(mixture);
  MomentSums sums(mixture.dimension(), mixture.size());
  double log_likelihood = 0;
  for (Eigen::Index begin = 0; begin < points.points.cols(); begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, points.points.cols() - begin);
    Posterior block = posterior(components, points.points.middleCols(begin, count));
    const Eigen::VectorXd weights = points.weights.segment(begin, count);
    log_likelihood += weights.dot(block.log_densities);
    block.responsibilities.array().colwise() *= weights.array();
    sums.add(points.points.middleCols(begin, count), block.responsibilities);
  }
  return {sums.moments(), log_likelihood / points.weights.sum()};
}

Moments moments_of_clusters(const WeightedPoints& points,
                            const std::vector<Eigen::Index>& component_of_point,
                            Eigen::Index components) {
  MomentSums sums(points.points.rows(), components);
  for (Eigen::Index begin = 0; begin < points.points.cols(); begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, points.points.cols() - begin);
    Eigen::MatrixXd masses = Eigen::MatrixXd::Zero(count, components);
    for (Eigen::Index i = 0; i < count; ++i)
      masses(i, component_of_point[static_cast<std::size_t>(begin + i)]) =
          points.weights[begin + i];
    sums.add(points.points.middleCols(begin, count), masses);
  }
  return sums.moments();
}

Mixture maximisation(const Moments& moments, double covariance_floor) {
  const Eigen::Index dimension = moments.sums.rows();
  const double least_mass = std::min(static_cast<double>(dimension + 1), moments.masses.maxCoeff());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < moments.masses.size(); ++k)
    if (moments.masses[k] >= least_mass)
      kept.push_back(k);

  Eigen::VectorXd weights(static_cast<Eigen::Index>(kept.size()));
  Eigen::MatrixXd means(dimension, weights.size());
  std::vector<Eigen::MatrixXd> covariances;
  for (Eigen::Index column = 0; column < weights.size(); ++column) {
    const Eigen::Index k = kept[static_cast<std::size_t>(column)];
    const double mass = moments.masses[k];
    weights[column] = mass;
    means.col(column) = moments.sums.col(k) / mass;
    Eigen::MatrixXd covariance(dimension, dimension);
    Eigen::Index entry = 0;
    for (Eigen::Index i = 0; i < dimension; ++i)
      for (Eigen::Index j = i; j < dimension; ++j) {
        covariance(i, j) = moments.squares(entry++, k) / mass - means(i, column) * means(j, column);
        covariance(j, i) = covariance(i, j);
      }
    covariance.diagonal() = covariance.diagonal().cwiseMax(0).array() + covariance_floor;
    covariances.push_back(std::move(covariance));
  }
  return {weights / weights.sum(), std::move(means), std::move(covariances)};
}

}  // namespace kinship::density
