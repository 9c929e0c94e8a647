#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "proto/types/profile.hpp"
#include "proto/types/uuid.hpp"
#include "server/fitting/source_masses.hpp"
#include "server/transfer/transferred_path.hpp"

namespace kinship::fitting {

/// Collects the configurations of transferred paths, source by source, and computes their weights
/// in a fit. Not shared between threads.
class PooledConfigurations {
 public:
  /// \param dof  of the target robot.
  explicit PooledConfigurations(Eigen::Index dof) : dof_(dof) {}

  /// Begins a source: paths added from now on belong to it.
  /// \param own  the source is the target robot itself.
  void begin_source(bool own);

  /// \param report  of the path.
  /// \throws std::invalid_argument if the configurations have another number of joints, or their
  ///         number differs from that of the weights; std::logic_error without a source.
  void add(std::shared_ptr<const transfer::TransferredPath> path, const Uuid& report = {});

  Eigen::Index size() const noexcept { return size_; }  ///< number of configurations

  struct PooledPath {
    std::size_t source = 0;  ///< counts from 0 in the order of begin_source()
    Uuid report;
    std::shared_ptr<const transfer::TransferredPath> path;  ///< with at least one configuration
  };
  /// In the order of addition; their configurations one after the other are configurations().
  const std::vector<PooledPath>& paths() const noexcept { return paths_; }
  Eigen::MatrixXd configurations() const;  ///< dof x N, in the order of addition
  /// N: index into paths() of each configuration.
  std::vector<std::uint32_t> path_of_configuration() const;

  /// N weights with sum N. Equal path weights: those of every path with configurations of a source
  /// sum to the same; otherwise the weights of the transfer. Weighting::Sources: each source then
  /// has its mass (source_masses.hpp). Weighting::Paths: sources make no difference.
  Eigen::VectorXd weights(const DensityParameters& parameters) const;

  /// The share of each source in such weights; sum 1, or all 0 without configurations.
  std::vector<double> masses(const Eigen::Ref<const Eigen::VectorXd>& weights) const;

 private:
  Eigen::Index dof_;
  Eigen::Index size_ = 0;
  std::vector<PooledSource> sources_;
  std::vector<PooledPath> paths_;
};

}  // namespace kinship::fitting
