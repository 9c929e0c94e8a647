#pragma once

#include <cstdint>
#include <optional>

#include "server/store/sqlite/database.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// \return the revision given: 1, then one more at each call for the same id, also after an
/// eviction. \throws Failure(NotFound) if its robot is not registered; Failure(InvalidInput) if it
/// could not
///         be read back: more sources or components than the limits, a placement that is no pose.
std::uint64_t upsert_distribution(Database& database, const Distribution& distribution);

/// A distribution without its store epoch.
struct DistributionRead {
  std::optional<Distribution> distribution;
  bool damaged = false;  ///< it is there, but cannot be used
};
DistributionRead select_distribution(Database& database, const Digest& id);

/// The one in this row, of any schema.
DistributionRead read_distribution(Database& database, std::int64_t row);

/// Deletes a distribution; its revision is kept, so that the next one counts on.
/// \return whether it was there.
bool delete_distribution(Database& database, const Digest& id);

}  // namespace kinship::store
