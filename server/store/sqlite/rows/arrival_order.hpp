#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "proto/types/digest.hpp"
#include "server/store/sqlite/database/database.hpp"

/// Attempts in the order in which they came. The one writer gives growing ids, so an id is a
/// cursor that nothing is committed behind.
namespace kinship::store {

/// The next attempts by id, those that are not set aside: of a robot, a task, both, or all of them.
std::vector<std::int64_t> next_attempts(Database& database, const std::optional<Digest>& robot,
                                        std::string_view task, std::int64_t after_id,
                                        std::int64_t count);

}  // namespace kinship::store
