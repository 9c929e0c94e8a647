#include "server/density/merge.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/stopped.hpp"

namespace kinship::density {
namespace {

struct Component {
  double weight = 0;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double log_determinant = 0;
};

/// Infinite if rounding leaves the covariance no factor: such a pair is never the cheapest.
double log_determinant(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success)
    return std::numeric_limits<double>::infinity();
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

/// The one Gaussian with the mean and covariance of two.
Component pair_of(const Component& a, const Component& b) {
  Component pair;
  pair.weight = a.weight + b.weight;
  const double part = pair.weight > 0 ? a.weight / pair.weight : 0.5;
  const Eigen::VectorXd difference = a.mean - b.mean;
  pair.mean = part * a.mean + (1 - part) * b.mean;
  pair.covariance = part * a.covariance + (1 - part) * b.covariance +
                    part * (1 - part) * difference * difference.transpose();
  pair.log_determinant = log_determinant(pair.covariance);
  return pair;
}

double cost_of(const Component& a, const Component& b) {
  return 0.5 * (a.weight + b.weight) * pair_of(a, b).log_determinant -
         0.5 * a.weight * a.log_determinant - 0.5 * b.weight * b.log_determinant;
}

/// Components and, for each, its cheapest partner of a higher index.
class Merging {
 public:
  Merging(const Mixture& mixture, const std::stop_token& stop) : stop_(stop) {
    for (Eigen::Index k = 0; k < mixture.size(); ++k) {
      const Eigen::MatrixXd& covariance = mixture.covariance(k);
      components_.push_back(
          {mixture.weights()[k], mixture.means().col(k), covariance, log_determinant(covariance)});
      if (!std::isfinite(components_.back().log_determinant))
        throw Failure(ErrorCode::Internal, "merge: a covariance is not positive definite");
    }
    partners_.resize(components_.size());
    for (std::size_t i = 0; i < components_.size(); ++i)
      find_partner(i);
  }

  std::size_t size() const noexcept { return components_.size(); }

  void merge_cheapest() {
    std::size_t first = 0;
    for (std::size_t i = 1; i + 1 < partners_.size(); ++i)
      if (partners_[i].cost < partners_[first].cost)
        first = i;
    if (!std::isfinite(partners_[first].cost))
      throw Failure(ErrorCode::Internal, "merge: no pair has a positive definite covariance");
    const std::size_t second = partners_[first].index;
    components_[first] = pair_of(components_[first], components_[second]);
    components_.erase(components_.begin() + static_cast<std::ptrdiff_t>(second));
    partners_.erase(partners_.begin() + static_cast<std::ptrdiff_t>(second));
    for (std::size_t i = 0; i < components_.size(); ++i) {
      Partner& partner = partners_[i];
      if (i == first || partner.index == first || partner.index == second) {
        find_partner(i);
        continue;
      }
      if (partner.index > second)
        --partner.index;
      if (i < first)
        offer(i, first);
    }
  }

  Mixture mixture() const {
    const auto size = static_cast<Eigen::Index>(components_.size());
    Eigen::VectorXd weights(size);
    Eigen::MatrixXd means(components_[0].mean.size(), size);
    std::vector<Eigen::MatrixXd> covariances;
    for (Eigen::Index k = 0; k < size; ++k) {
      const Component& component = components_[static_cast<std::size_t>(k)];
      weights[k] = component.weight;
      means.col(k) = component.mean;
      covariances.push_back(component.covariance);
    }
    return {weights, means, covariances};
  }

 private:
  struct Partner {
    std::size_t index = 0;
    double cost = std::numeric_limits<double>::infinity();
  };

  void offer(std::size_t i, std::size_t other) {
    const double cost = cost_of(components_[i], components_[other]);
    if (cost < partners_[i].cost)
      partners_[i] = {other, cost};
  }
  void find_partner(std::size_t i) {
    throw_if_stopped(stop_);  // a thousand pairs cost some milliseconds
    partners_[i] = {};
    for (std::size_t other = i + 1; other < components_.size(); ++other)
      offer(i, other);
  }

  const std::stop_token& stop_;
  std::vector<Component> components_;
  std::vector<Partner> partners_;
};

}  // namespace

Mixture merged(const Mixture& mixture, Eigen::Index components, const std::stop_token& stop) {
  if (mixture.size() <= components)
    return mixture;
  Merging merging(mixture, stop);
  while (merging.size() > static_cast<std::size_t>(components))
    merging.merge_cheapest();
  return merging.mixture();
}

}  // namespace kinship::density
