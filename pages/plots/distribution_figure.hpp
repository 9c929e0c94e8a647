#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "pages/plots/distribution_plot.hpp"
#include "pages/plots/look_up.hpp"
#include "pages/plots/lost_poses.hpp"
#include "proto/types/summaries.hpp"

namespace kinship::plots {

inline constexpr std::size_t kMaxKept = 16;          ///< the newest fits
inline constexpr Eigen::Index kSamplesOfKept = 500;  ///< of each

/// A distribution that the server keeps of the same robot, task and placement as another, made
/// with another profile, of other experience or by another version.
struct KeptDistribution {
  DistributionSummary summary;
  std::string engines;
  Samples samples;
};

/// The kept ones with a mixture, and the distribution itself among them; in the order of their
/// fits. Of each, the server keeps the newest revision alone.
/// \throws Failure of LookUp::distributions.
std::vector<KeptDistribution> kept_beside(const Distribution& distribution,
                                          const kinematics::Chain& chain, const LookUp& look_up);

/// A distribution, what its transfer lost, and the others that are kept.
struct DistributionFigure {
  DistributionPlot plot;
  LostPoses lost;
  std::vector<KeptDistribution> kept;
};

/// \throws Failure as plot_of, as LookUp::robot and drawn_robot of its robot, as lost_poses and
///         kept_beside.
DistributionFigure distribution_figure(Distribution distribution, const LookUp& look_up);

}  // namespace kinship::plots
