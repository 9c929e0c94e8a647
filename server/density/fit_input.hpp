#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/result.hpp"
#include "server/density/distinct_points.hpp"

/// What every estimator asks of its input.
namespace kinship::density {

inline constexpr double kLargestValue = 1e6;  ///< joint units; squares still leave room for floors

/// The distinct configurations (d x N) of positive weight (N); or InvalidInput: a number that is
/// not finite or too large, a weight below 0, a sum of weights that is not positive and finite, or
/// fewer distinct configurations than the d + 1 that a covariance needs.
/// \param who  named in the message.
Result<DistinctPoints> usable_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                     const Eigen::Ref<const Eigen::VectorXd>& weights,
                                     std::string_view who);

/// InvalidInput: a computation with covariances failed, so the floors are too small for the data.
Error too_flat(const Failure& failure, const Eigen::VectorXd& floors, std::string_view who);

/// What an estimator makes of usable points, or why it cannot.
/// \param floors  d, added to each variance; named where a Failure says that they are too small.
/// \param make    DistinctPoints -> the estimate.
template <typename Make>
Result<std::invoke_result_t<Make, DistinctPoints>> estimate_of(
    const Eigen::Ref<const Eigen::MatrixXd>& configurations,
    const Eigen::Ref<const Eigen::VectorXd>& weights, const Eigen::VectorXd& floors,
    std::string_view who, const Make& make) {
  Result<DistinctPoints> points = usable_points(configurations, weights, who);
  if (!points)
    return points.error();
  try {
    return make(std::move(points).value());
  } catch (const Failure& failure) {
    return too_flat(failure, floors, who);
  }
}

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
