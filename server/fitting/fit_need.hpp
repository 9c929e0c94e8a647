#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "server/fitting/distribution_key.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::fitting {

/// Upper bound of the resources of a fit, from numbers known before the transfer.
struct FitNeed {
  std::uint64_t paths = 0;      ///< that are transferred
  std::uint64_t poses = 0;      ///< of all of them together
  std::uint64_t longest = 0;    ///< poses of the path with the most
  std::uint64_t solutions = 0;  ///< of a pose: max_solutions, or tracks if they are more
  Eigen::Index dof = 0;         ///< of the target
  std::size_t bytes = 0;        ///< of memory at once
};

/// A fit, and the number of paths it reads from each source.
struct FitSize {
  const DistributionKey& key;
  const std::vector<store::ExperienceSummary>& experience;
  const std::vector<std::uint64_t>& wanted;  ///< paths, one number per source
  Eigen::Index dof = 0;                      ///< of the target
  int threads = 1;
};

/// With as many poses per path as the profile allows; if it has no limit, as a path may have
/// waypoints. Reads nothing.
FitNeed need_at_most(const FitSize& size);

/// The same with the lengths of the paths, which the store has: of each source the longest ones.
/// Reads a listing of the source's paths. \throws Failure(Storage); Stopped.
FitNeed need_by_length(const FitSize& size, const store::ExperienceStore& store,
                       const std::stop_token& stop);

/// One configuration of the pool, with every copy that a fit makes of it.
std::size_t bytes_of_configuration(Eigen::Index dof);

/// "a fit could need 5243 MB: 4000 paths with 65536000 poses together, up to 100 configurations of
/// 7 joints each; the limit is 2048 MB (kinshipd --fit-memory-mb). Ask for less with ...".
std::string describe(const FitNeed& need, std::size_t max_bytes);

}  // namespace kinship::fitting
