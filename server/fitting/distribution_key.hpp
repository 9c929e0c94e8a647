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

/// What a distribution is a function of, besides the experience.
struct DistributionKey {
  std::string task;
  Digest robot;                                  ///< the target
  std::optional<Eigen::Isometry3d> T_task_base;  ///< snapped; missing is not the identity
  /// Its values count, not its name. Its weighting is the one of the request, if that has one.
  Profile profile;
  std::vector<Digest> sources = {};  ///< whose experience, ascending and distinct; empty: all
  std::int64_t since_ms = 0;         ///< paths received at or after, Unix time, UTC; 0: all
  /// That of the target: how often better geometry was taken over. 0 where no filter is wanted.
  std::uint64_t geometry_revision = 0;
};

/// What a request asks for that breaks no rule of the contract.
/// \param geometry_revision  of the request's robot; 0: nothing better was ever taken over.
/// \return the key, or InvalidInput if there is no such profile.
Result<DistributionKey> make_key(const FetchRequest& request, std::uint64_t geometry_revision = 0);

/// The id of the distribution: a digest of the key and of the versions of the code that makes it.
Digest identify(const DistributionKey& key);

/// Version of how paths are chosen, pooled and weighed; part of the id. Raised when that changes.
inline constexpr int kPoolVersion = 2;

/// The versions in words, e.g. "pool 1, transfer 1, inverse 1, density 1".
std::string engines();

}  // namespace kinship::fitting
