#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"

namespace kinship::service {

/// What a distribution is a function of, besides the experience.
struct DistributionKey {
  std::string task;
  Digest robot;                                  ///< the target
  std::optional<Eigen::Isometry3d> T_task_base;  ///< snapped; missing is not the identity
  Profile profile;                               ///< its values count, not its name
};

/// What a request asks for.
/// \return the key, or InvalidInput if task, profile or placement break a rule.
Result<DistributionKey> make_key(const FetchRequest& request);

/// The id of the distribution: a digest of the key and of the versions of the code that makes it.
Digest identify(const DistributionKey& key);

/// The versions in words, e.g. "transfer 1, inverse 1, density 1".
std::string engines();

}  // namespace kinship::service
