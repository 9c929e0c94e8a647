#pragma once

#include <memory>
#include <string>

#include "server/store/moving/side.hpp"

namespace kinship::store::moving {

/// A database that is moved from. Servers may have it open.
/// \throws Failure(NotFound) if there is no store in it; Failure(Storage), Failure(InvalidInput).
std::unique_ptr<Side> open_postgres_source(const std::string& url);

/// A database that is moved to; it gets our tables if it has none.
std::unique_ptr<Side> open_postgres_target(const std::string& url);

}  // namespace kinship::store::moving
