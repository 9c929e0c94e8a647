#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/fitting/distribution_key.hpp"
#include "server/fitting/fit_memory.hpp"
#include "server/fitting/source_transfer.hpp"

namespace kinship::fitting {

/// Input of the coming fit.
struct Refit {
  const DistributionKey& key;
  const KnownPaths& paths;                    ///< used in it
  const std::vector<SourceSummary>& sources;  ///< outcome of each
  const std::vector<double>& masses;          ///< of each
  const Eigen::MatrixXd& configurations;      ///< dof x N, as transferred
  const kinematics::Chain& target;
};

/// Source robots of which a path was used, and their masses.
std::vector<Digest> used_sources(const std::vector<SourceSummary>& sources);
std::vector<double> used_masses(const std::vector<SourceSummary>& sources,
                                const std::vector<double>& masses);

/// Why a fit may not start from the state of the previous one, as a short text; empty: it may.
/// \param before  may be null.
std::string why_full(const Refit& refit, const WarmState* before);

/// A refit is a full one from this many times the paths of the last full fit on.
inline constexpr std::uint64_t kFullFitGrowth = 2;
/// A refit is also a full one if the mass of a source has changed by more since then.
inline constexpr double kMassJump = 0.1;

}  // namespace kinship::fitting
