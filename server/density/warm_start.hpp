#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "proto/types/mixture.hpp"
#include "server/density/distinct_points.hpp"
#include "server/density/em_run.hpp"

namespace kinship::density {

/// Start of a fit of configurations most of which were fitted before.
struct WarmStart {
  Mixture mixture;  ///< of the fit before: as many joints, means at most twice the largest value
  /// N: non-zero for a configuration to which `mixture` was not fitted.
  std::vector<std::uint8_t> is_new;
  Eigen::MatrixXd prior_scatter = {};  ///< of the fit before; empty: it had no prior
};

/// The previous mixture and a few clusters of the new configurations that it describes worse than
/// 99 % of the old ones. Without them, components that are needed elsewhere would stretch to cover
/// new modes.
/// \param points  all distinct configurations.
/// \return `warm.mixture` itself if it describes the new ones well enough.
Mixture with_components_for_new(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                const DistinctPoints& points, const WarmStart& warm,
                                std::uint64_t seed, const EmOptions& options);

/// Maximum number of clusters added.
inline constexpr Eigen::Index kMaxNewComponents = 16;

/// Points and iterations of EM with them, before components are merged down again.
inline constexpr Eigen::Index kWarmSamplePoints = 5'000;
inline constexpr int kIterationsBeforeMerging = 4;

/// EM over all points after that, if they are more.
inline constexpr int kWarmPasses = 2;

}  // namespace kinship::density
