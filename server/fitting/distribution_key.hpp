#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"

namespace kinship::fitting {

/// The inputs that determine a distribution, besides the experience.
struct DistributionKey {
  std::string task;
  Digest robot;                                  ///< the target
  std::optional<Eigen::Isometry3d> T_task_base;  ///< snapped; missing is not the identity
  /// Its values matter, not its name. Its weighting is that of the request, if the request has one.
  Profile profile;
  std::vector<Digest> sources = {};  ///< whose experience, ascending and distinct; empty: all
  std::int64_t since_ms = 0;         ///< paths received at or after, Unix time, UTC; 0: all
  /// Of the target: number of times better geometry was taken over. 0 if the profile has no filter.
  std::uint64_t geometry_revision = 0;
};

/// The key of a request that breaks no rule of the contract.
/// \param geometry_revision  of the request's robot; 0: better geometry was never taken over.
/// \return the key, or InvalidInput if there is no such profile.
Result<DistributionKey> make_key(const FetchRequest& request, std::uint64_t geometry_revision = 0);

/// The id of the distribution: a digest of the key and of the versions of the code that fits it.
Digest identify(const DistributionKey& key);

/// Version of the code that chooses, pools and weights paths; part of the id. Raised when its
/// output changes.
inline constexpr int kPoolVersion = 2;

/// The versions as text, e.g. "pool 1, transfer 1, inverse 1, density 1".
std::string engines();

}  // namespace kinship::fitting
