#include "server/service/pooled_configurations.hpp"

#include <stdexcept>
#include <utility>

namespace kinship::service {

void PooledConfigurations::add(transfer::TransferredPath path) {
  const Eigen::Index count = path.configurations.cols();
  if (path.weights.size() != count || (count > 0 && path.configurations.rows() != dof_))
    throw std::invalid_argument("PooledConfigurations: need dof x n configurations and n weights");
  if (count == 0)
    return;
  size_ += count;
  paths_.push_back(std::move(path));
}

Eigen::MatrixXd PooledConfigurations::configurations() const {
  Eigen::MatrixXd pooled(dof_, size_);
  Eigen::Index column = 0;
  for (const transfer::TransferredPath& path : paths_) {
    pooled.middleCols(column, path.configurations.cols()) = path.configurations;
    column += path.configurations.cols();
  }
  return pooled;
}

Eigen::VectorXd PooledConfigurations::weights(bool equal_path_weights) const {
  Eigen::VectorXd pooled(size_);
  Eigen::Index row = 0;
  for (const transfer::TransferredPath& path : paths_) {
    const double total = equal_path_weights ? path.weights.sum() : 1.0;
    pooled.segment(row, path.weights.size()) = path.weights / total;
    row += path.weights.size();
  }
  if (size_ > 0)
    pooled *= static_cast<double>(size_) / pooled.sum();
  return pooled;
}

}  // namespace kinship::service
