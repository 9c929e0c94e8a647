#pragma once

#include <Eigen/Core>

#include "proto/mixture/component_densities.hpp"

namespace kinship::density {

/// What a mixture says about configurations.
struct Posterior {
  Eigen::MatrixXd responsibilities;  ///< N x K; rows are non-negative and sum to 1
  Eigen::VectorXd log_densities;     ///< N, of the whole mixture, nats
};

/// Posterior probability of each component given each configuration.
/// \param configurations  d x N; the result takes 8 N K bytes: evaluate in blocks.
/// \throws std::invalid_argument if configurations.rows() != components.dimension().
///
/// Computed in the log domain, so a configuration far from every component still gets a row that
/// sums to 1.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.23.
Posterior posterior(const mixture::ComponentDensities& components,
                    const Eigen::Ref<const Eigen::MatrixXd>& configurations);

}  // namespace kinship::density
