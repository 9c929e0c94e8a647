#pragma once

#include <optional>
#include <vector>

#include "server/catalog/pending_fit.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// What the store knows about a distribution.
struct LookUp {
  /// Unknown robot, unreadable robot, unknown source, no experience: nothing can be fitted.
  std::optional<FetchReply> end;
  SharedReply known;                                 ///< null: there is none that may be served
  std::vector<store::ExperienceSummary> experience;  ///< of the key's selection
};

/// Finds a distribution and the experience it would be made of now. One whose paths were retired
/// since is not there.
/// \param in_memory  the distribution, if it need not be read; may be null.
/// \throws Failure(Storage)
LookUp look_up(const Digest& id, const fitting::DistributionKey& key, const SharedReply& in_memory,
               const store::Store& store, runtime::RobotRegistry& robots);

}  // namespace kinship::catalog
