#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/mixture.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"
#include "server/density/component_search.hpp"
#include "server/density/expectation_maximisation.hpp"
#include "server/density/hold_out.hpp"
#include "server/density/warm_start.hpp"

namespace kinship::density {

struct FitOptions {
  /// K, lowered to a number that the configurations can support. 0: chosen by hold-out of paths.
  int components = 50;
  double covariance_floor = 1e-4;  ///< added to each variance, squared joint units
  /// d, instead of covariance_floor, where joints have different units; empty: all the same.
  Eigen::VectorXd floors_of_joints = {};
  /// How strongly covariances are drawn towards the mean covariance of the k-means clusters: as
  /// this many points in each component would (prior_scatter). 0: not at all. kChosenPrior: chosen
  /// by hold-out of paths.
  double prior = 0;
  int max_iterations = 50;  ///< 0: the start as it is
  double tolerance = 1e-2;  ///< stop when the mean log-likelihood gains less, nats
  std::uint64_t seed = 0;
  Computation computation = {};
  /// N: the path of each configuration, numbered from 0 without gaps. Needed to choose K or a
  /// prior.
  std::vector<std::uint32_t> path_of_configuration = {};
  /// 2 x d, lower and upper, joint units: within them scores have their uniform background. Empty:
  /// the box of the configurations.
  Eigen::Matrix2Xd limits = {};
  /// If most of the configurations were fitted before: EM begins with that mixture and with
  /// clusters of the configurations that it describes badly, which are merged down again. With
  /// components = 0, K stays as it was; the prior does in any case. Empty: a full fit.
  std::optional<WarmStart> warm_start = {};
};

struct FitSummary {
  Mixture mixture;
  /// Weighted mean per configuration after each iteration over all of them, nats; the last is that
  /// of `mixture`.
  std::vector<double> log_likelihoods;
  /// If K was chosen by hold-out: the scores, from most components to fewest.
  std::vector<ComponentScore> curve = {};
  /// On the fifth of the paths given by held_out_paths(): the highest of the curve, or that of the
  /// chosen prior.
  std::optional<double> held_out_score = {};
  double prior = 0;                    ///< that was used; 0 after a warm start
  Eigen::MatrixXd prior_scatter = {};  ///< d x d, for a warm start; empty: there was no prior
};

/// Fits a Gaussian mixture with full covariances: k-means++ start, Lloyd iterations, EM.
///
/// A K to be chosen is the one that scores best on a fifth of the paths (held_out_paths,
/// prune_components) after a fit to the others; a mixture of that K is then refitted to all. Below
/// kMinPathsToScore paths it is components_of_few_paths, without a curve.
///
/// A prior to be chosen is the one of choose_prior() on at most kPriorPoints of the paths' points,
/// with as many components as the fit has; kPriorOfOnePath if no path can be held out.
///
/// A warm start adds at most kMaxNewComponents, runs EM on a sample (kIterationsBeforeMerging),
/// merges down to K and runs EM again, at most kWarmPasses times if the sample is not all points:
/// cheaper than a full fit, and its result depends on the mixture it began with. It leaves curve
/// and held_out_score empty.
///
/// K is lowered so that each component can have 2 (d + 1) distinct configurations, and components
/// that lose their data on the way are left out. With more than one and a half times kSamplePoints
/// or kSamplePointsPerComponent K configurations EM sees such a sample first, and then all of them
/// at most kFullPasses times. Deterministic: equal input, equal bytes, whatever the number of
/// threads. Neither the order of the configurations nor repetition instead of weight matters beyond
/// rounding.
/// \param configurations  d x N, at most 1e6 in magnitude, joint units.
/// \param weights         N, non-negative, positive sum.
/// \return the mixture, or InvalidInput if there are fewer than d + 1 distinct configurations of
///         positive weight, a number is not finite or too large, no weight is positive, or the
///         configurations are degenerate and the covariance floor too small to make up for it.
/// \throws std::invalid_argument if sizes differ or an option is outside its range; Stopped.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), section 9.2; Arthur and
/// Vassilvitskii, k-means++ (2007).
Result<FitSummary> fit_mixture(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const FitOptions& options);

inline constexpr Eigen::Index kSamplePointsPerComponent = 400;
inline constexpr Eigen::Index kPriorPoints = 8'000;
inline constexpr int kFullPasses = 6;

/// K if there are too few paths to choose it: one per four paths, at least 1.
int components_of_few_paths(std::uint32_t paths);

/// Version of this code; part of a distribution's key. Raised when its output changes.
inline constexpr int kDensityVersion = 5;

}  // namespace kinship::density
