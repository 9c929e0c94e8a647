#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "proto/types/mixture.hpp"
#include "server/density/distinct_points.hpp"
#include "server/density/em_run.hpp"

namespace kinship::density {

/// What a fit of configurations knows that were, but for some, fitted before.
struct WarmStart {
  Mixture mixture;  ///< of the fit before: as many joints, means at most twice the largest value
  /// N: not 0 for a configuration that `mixture` was not fitted to.
  std::vector<std::uint8_t> is_new;
  Eigen::MatrixXd prior_scatter = {};  ///< of the fit before; empty: it had no prior
};

/// The mixture before, and beside it a few clusters of the new configurations that it describes
/// worse than all but a hundredth of the old ones. Modes that the new ones bring would else be
/// covered by stretching components that are needed elsewhere.
/// \param points  all of the configurations' distinct ones.
/// \return `warm.mixture` itself if it describes the new ones well enough.
Mixture with_components_for_new(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                const DistinctPoints& points, const WarmStart& warm,
                                std::uint64_t seed, const EmOptions& options);

/// Most clusters that are added.
inline constexpr Eigen::Index kMaxNewComponents = 16;

/// EM with them on so many of the points, before components are merged down again.
inline constexpr Eigen::Index kWarmSamplePoints = 5'000;
inline constexpr int kIterationsBeforeMerging = 4;

/// EM over all points after that, where they are more.
inline constexpr int kWarmPasses = 2;

}  // namespace kinship::density
