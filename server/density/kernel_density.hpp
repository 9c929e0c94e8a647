#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/mixture.hpp"
#include "proto/types/result.hpp"
#include "server/density/expectation_maximisation.hpp"

namespace kinship::density {

struct KernelDensityOptions {
  Eigen::VectorXd floors_of_joints;  ///< d, added to each variance, squared joint units
  std::uint64_t seed = 0;
  Computation computation = {};
  /// N: the path of each configuration, numbered from 0 without gaps.
  std::vector<std::uint32_t> path_of_configuration;
  /// 2 x d, lower and upper, joint units: centres that lie within stay there, and scores have their
  /// uniform background there. Empty: the box of the configurations.
  Eigen::Matrix2Xd limits = {};
};

/// The covariance of a kernel is scale^2 times the mean covariance of `clusters` k-means clusters
/// of the configurations, plus the floors.
struct Bandwidth {
  int clusters = 1;
  double scale = 1;

  bool operator==(const Bandwidth&) const = default;
};

struct KernelDensity {
  Mixture mixture;  ///< at most kMaxKernels components, one covariance, means that f32 can hold
  Bandwidth bandwidth;
  /// On the first fifth of the paths (held_out_paths), of kernels of the others with the chosen
  /// bandwidth; none below kMinPathsToScore paths.
  std::optional<double> held_out_score = {};
};

/// A kernel density estimate: a Gaussian at each distinct configuration, its weight that of the
/// configuration, all with one covariance.
///
/// Of more than kMaxKernels configurations a sample of that size is drawn in proportion to weight,
/// spread evenly over space. The bandwidth is the one that scores best on held-out paths: a fifth
/// of the paths (held_out_paths); up to 60 of them the mean over each fifth in turn, below
/// kMinPathsToScore over each path in turn; with one path it is scale_of_one_path(d) and one
/// cluster. Centres are rounded to f32, towards the inside of a limit they would cross.
/// Deterministic: equal input, equal bytes, whatever the number of threads.
/// \param configurations  d x N, at most 1e6 in magnitude, joint units.
/// \param weights         N, non-negative, positive sum.
/// \return InvalidInput as fit_mixture.
/// \throws std::invalid_argument if sizes differ or an option is outside its range; Stopped.
/// Source: Silverman, Density Estimation for Statistics and Data Analysis (1986), sections 3.4.4
/// (likelihood cross-validation) and 4.2; Iversen and Ellekilde, Kernel density estimation based
/// self-learning sampling strategy for motion planning of repetitive tasks (2016), for the use in
/// planning.
Result<KernelDensity> estimate_kernel_density(
    const Eigen::Ref<const Eigen::MatrixXd>& configurations,
    const Eigen::Ref<const Eigen::VectorXd>& weights, const KernelDensityOptions& options);

/// Silverman's rule (1986, section 4.3.2) for a sample of one: the distance to another path depends
/// on the paths, not on the number of their configurations.
double scale_of_one_path(Eigen::Index dimension);

}  // namespace kinship::density
