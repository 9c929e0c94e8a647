#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"

/// What every estimator asks of its input.
namespace kinship::density {

inline constexpr double kLargestValue = 1e6;  ///< joint units; squares still leave room for floors

/// What is wrong with configurations (d x N) or their weights (N): a number that is not finite or
/// too large, a weight below 0, or a sum of weights that is not positive and finite.
std::optional<Error> check_input(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                 const Eigen::Ref<const Eigen::VectorXd>& weights);

/// \throws std::invalid_argument unless there is a joint, one weight per configuration, and limits
/// that are empty or, per joint, finite and not crossed.
/// \param who  named in the message.
void check_sizes(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                 const Eigen::Ref<const Eigen::VectorXd>& weights, const Eigen::Matrix2Xd& limits,
                 std::string_view who);

/// Whether each configuration has a path, and each path from 0 to the last one a configuration.
bool are_paths_of(const std::vector<std::uint32_t>& path_of_configuration,
                  Eigen::Index configurations);

/// Logarithm of the density of the uniform distribution within limits.
/// \param configurations  d x N, N >= 1.
/// \param limits          2 x d; or empty: the box of the configurations.
double log_uniform(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Matrix2Xd& limits);

}  // namespace kinship::density
