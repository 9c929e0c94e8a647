#include "server/fitting/pooled_configurations.hpp"

#include <numeric>
#include <stdexcept>
#include <utility>

namespace kinship::fitting {

void PooledConfigurations::begin_source(bool own) { sources_.push_back({.paths = 0, .own = own}); }

void PooledConfigurations::add(std::shared_ptr<const transfer::TransferredPath> path,
                               const Uuid& report) {
  const Eigen::Index count = path->configurations.cols();
  if (path->weights.size() != count || (count > 0 && path->configurations.rows() != dof_))
    throw std::invalid_argument("PooledConfigurations: need dof x n configurations and n weights");
  if (sources_.empty())
    throw std::logic_error("PooledConfigurations: a path before the first source");
  if (count == 0)
    return;
  size_ += count;
  ++sources_.back().paths;
  paths_.push_back({sources_.size() - 1, report, std::move(path)});
}

Eigen::MatrixXd PooledConfigurations::configurations() const {
  Eigen::MatrixXd pooled(dof_, size_);
  Eigen::Index column = 0;
  for (const PooledPath& pooled_path : paths_) {
    const Eigen::MatrixXd& configurations = pooled_path.path->configurations;
    pooled.middleCols(column, configurations.cols()) = configurations;
    column += configurations.cols();
  }
  return pooled;
}

std::vector<std::uint32_t> PooledConfigurations::path_of_configuration() const {
  std::vector<std::uint32_t> path_of;
  path_of.reserve(static_cast<std::size_t>(size_));
  for (std::size_t path = 0; path < paths_.size(); ++path)
    path_of.insert(path_of.end(),
                   static_cast<std::size_t>(paths_[path].path->configurations.cols()),
                   static_cast<std::uint32_t>(path));
  return path_of;
}

Eigen::VectorXd PooledConfigurations::weights(const DensityParameters& parameters) const {
  Eigen::VectorXd pooled(size_);
  std::vector<double> sum_of_source(sources_.size(), 0);
  Eigen::Index row = 0;
  for (const auto& [source, report, path] : paths_) {
    const double total = parameters.equal_path_weights ? path->weights.sum() : 1.0;
    auto segment = pooled.segment(row, path->weights.size());
    segment = path->weights / total;
    sum_of_source[source] += segment.sum();
    row += path->weights.size();
  }
  if (parameters.weighting == Weighting::Sources) {
    const std::vector<double> masses = source_masses(sources_);
    row = 0;
    for (const auto& [source, report, path] : paths_) {
      pooled.segment(row, path->weights.size()) *= masses[source] / sum_of_source[source];
      row += path->weights.size();
    }
  }
  if (size_ > 0)
    pooled *= static_cast<double>(size_) / pooled.sum();
  return pooled;
}

std::vector<double> PooledConfigurations::masses(
    const Eigen::Ref<const Eigen::VectorXd>& weights) const {
  std::vector<double> masses(sources_.size(), 0);
  Eigen::Index row = 0;
  for (const auto& [source, report, path] : paths_) {
    masses[source] += weights.segment(row, path->weights.size()).sum();
    row += path->weights.size();
  }
  // Divided by their own sum, which no rounding can make smaller than one of them.
  const double total = std::accumulate(masses.begin(), masses.end(), 0.0);
  for (double& mass : masses)
    mass = total > 0 ? mass / total : 0;
  return masses;
}

}  // namespace kinship::fitting
