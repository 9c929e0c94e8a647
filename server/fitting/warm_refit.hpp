#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/fitting/distribution_key.hpp"
#include "server/fitting/fit_memory.hpp"
#include "server/fitting/source_transfer.hpp"

namespace kinship::fitting {

/// What is about to be fitted.
struct Refit {
  const DistributionKey& key;
  const KnownPaths& paths;                    ///< used now
  const std::vector<SourceSummary>& sources;  ///< how each fared
  const std::vector<double>& masses;          ///< of each
  const Eigen::MatrixXd& configurations;      ///< dof x N, as they were transferred
  const kinematics::Chain& target;
};

/// Source robots of which a path was used, and their masses.
std::vector<Digest> used_sources(const std::vector<SourceSummary>& sources);
std::vector<double> used_masses(const std::vector<SourceSummary>& sources,
                                const std::vector<double>& masses);

/// Why a fit may not start from what the one before left, in a few words; empty: it may.
/// \param before  may be null.
std::string why_full(const Refit& refit, const WarmState* before);

/// From so many times the paths of the last full fit on a refit is a full one.
inline constexpr std::uint64_t kFullFitGrowth = 2;
/// And if the mass of a source has moved by more since then.
inline constexpr double kMassJump = 0.1;

}  // namespace kinship::fitting
