#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/result.hpp"
#include "server/density/block_points.hpp"
#include "server/density/distinct_points.hpp"

/// Checks of the input, common to all estimators.
namespace kinship::density {

inline constexpr double kLargestValue = 1e6;  ///< joint units; squares still leave room for floors

/// The distinct configurations (d x N) of positive weight (N); or InvalidInput: a number that is
/// not finite or too large, a weight below 0, a sum of weights that is not positive and finite, or
/// fewer distinct configurations than the d + 1 that a covariance needs.
/// \param who  named in the message.
/// \throws Stopped.
Result<DistinctPoints> usable_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                     const Eigen::Ref<const Eigen::VectorXd>& weights,
                                     std::string_view who, const std::stop_token& stop = {});

/// InvalidInput: a computation with covariances failed, so the floors are too small for the data.
Error too_flat(const Failure& failure, const Eigen::VectorXd& floors, std::string_view who);

/// Runs an estimator on the usable points. \return the estimate, or why there is none.
/// \param floors  d, added to each variance; named in the message of a Failure that they are too
///                small.
/// \param make    DistinctPoints -> the estimate.
template <typename Make>
Result<std::invoke_result_t<Make, DistinctPoints>> estimate_of(
    const Eigen::Ref<const Eigen::MatrixXd>& configurations,
    const Eigen::Ref<const Eigen::VectorXd>& weights, const Eigen::VectorXd& floors,
    std::string_view who, const std::stop_token& stop, const Make& make) {
  Result<DistinctPoints> points = usable_points(configurations, weights, who, stop);
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

/// Configurations with their weights and paths: all of them, or the parts that are fitted and
/// scored if some paths are held out. The arguments outlive the object.
class WeightedConfigurations {
 public:
  /// \param configurations         d x N.
  /// \param weights                N.
  /// \param path_of_configuration  N, or empty if paths are not needed.
  WeightedConfigurations(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                         const Eigen::Ref<const Eigen::VectorXd>& weights,
                         const std::vector<std::uint32_t>& path_of_configuration,
                         std::stop_token stop = {})
      : configurations_(configurations),
        weights_(weights),
        path_of_configuration_(path_of_configuration),
        stop_(std::move(stop)) {}

  std::uint32_t paths() const;  ///< how many
  /// Relative to their mean.
  BlockPoints blocks_of(DistinctPoints distinct) const;

  struct Split {
    DistinctPoints training;
    DistinctPoints held_out;
  };
  /// \param held_out  one flag per path.
  /// \return nothing if either side has too few points.
  std::optional<Split> split(const std::vector<std::uint8_t>& held_out) const;

 private:
  DistinctPoints part(const std::vector<std::uint8_t>& held_out, bool of_held_out) const;

  const Eigen::Ref<const Eigen::MatrixXd>& configurations_;
  const Eigen::Ref<const Eigen::VectorXd>& weights_;
  const std::vector<std::uint32_t>& path_of_configuration_;
  const std::stop_token stop_;
};

/// Logarithm of the density of the uniform distribution within limits.
/// \param configurations  d x N, N >= 1.
/// \param limits          2 x d; or empty: the box of the configurations.
double log_uniform(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Matrix2Xd& limits);

}  // namespace kinship::density
