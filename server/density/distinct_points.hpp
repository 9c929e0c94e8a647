#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <stop_token>
#include <vector>

namespace kinship::density {

/// Columns of a matrix of configurations that hold the distinct ones of positive weight, in
/// lexicographic order of the configurations, and their weights. So results do not depend on the
/// order or repetition of configurations.
struct DistinctPoints {
  std::vector<std::uint32_t> columns;
  std::vector<double> weights;  ///< positive, sum their number: the average point weighs 1
};

/// \param configurations  d x N, finite, N below 2^32.
/// \param weights         N, finite, non-negative. Equal configurations add up.
/// \param wanted          N, 0: left out; empty: all.
/// \throws Stopped.
DistinctPoints distinct_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const std::vector<std::uint8_t>& wanted = {},
                               const std::stop_token& stop = {});

}  // namespace kinship::density
