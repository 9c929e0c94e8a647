#include "server/density/weighted_points.hpp"

#include <algorithm>
#include <vector>

namespace kinship::density {

WeightedPoints prepare_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                              const Eigen::Ref<const Eigen::VectorXd>& weights) {
  std::vector<Eigen::Index> order;
  order.reserve(static_cast<std::size_t>(weights.size()));
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    if (weights[i] > 0)
      order.push_back(i);
  const auto less = [&](Eigen::Index a, Eigen::Index b) {
    for (Eigen::Index joint = 0; joint < configurations.rows(); ++joint)
      if (configurations(joint, a) != configurations(joint, b))
        return configurations(joint, a) < configurations(joint, b);
    return weights[a] < weights[b];  // so that the sum of equal ones has one order
  };
  std::sort(order.begin(), order.end(), less);

  WeightedPoints prepared;
  prepared.points.resize(configurations.rows(), static_cast<Eigen::Index>(order.size()));
  prepared.weights.resize(static_cast<Eigen::Index>(order.size()));
  Eigen::Index count = 0;
  for (const Eigen::Index i : order) {
    if (count > 0 && prepared.points.col(count - 1) == configurations.col(i)) {
      prepared.weights[count - 1] += weights[i];
      continue;
    }
    prepared.points.col(count) = configurations.col(i);
    prepared.weights[count] = weights[i];
    ++count;
  }
  prepared.points.conservativeResize(Eigen::NoChange, count);
  prepared.weights.conservativeResize(count);
  prepared.weights /= prepared.weights.mean();
  prepared.offset = prepared.points * prepared.weights / prepared.weights.sum();
  prepared.points.colwise() -= prepared.offset;
  return prepared;
}

}  // namespace kinship::density
