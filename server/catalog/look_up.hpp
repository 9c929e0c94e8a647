#pragma once

#include <optional>
#include <vector>

#include "server/catalog/pending_fit.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/distribution_store.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// The state of a distribution in the store.
struct LookUp {
  /// The final reply if nothing can be fitted: unknown or unreadable robot, unknown source, no
  /// experience.
  std::optional<FetchReply> end;
  bool has_no_paths = false;                         ///< no robot has any of the task
  SharedReply known;                                 ///< null: none may be served
  std::vector<store::ExperienceSummary> experience;  ///< of the key's selection
};

/// Finds a distribution and the experience that a fit would use now. A distribution with paths
/// retired since counts as missing.
/// \param in_memory  the distribution, if it need not be read; may be null.
/// \throws Failure(Storage)
LookUp look_up(const Digest& id, const fitting::DistributionKey& key, const SharedReply& in_memory,
               const store::ExperienceStore& store, const store::DistributionStore& distributions,
               runtime::RobotRegistry& robots);

}  // namespace kinship::catalog
