#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

namespace kinship::store::postgres {

/// Paths as read, and the ids of those whose checksum or content is wrong.
struct PathsRead {
  std::vector<StoredPath> paths;
  std::vector<std::int64_t> damaged;
};

/// The paths in use of a robot and task in the order of ids; damaged ones do not count towards the
/// limit. Some megabytes at a time are fetched.
PathsRead select_paths(Connection& connection, const Digest& robot, std::string_view task,
                       const PathRange& range);

/// The ids of the paths in use, ascending, from an index.
std::vector<std::int64_t> select_path_ids(Connection& connection, const Digest& robot,
                                          std::string_view task);

/// Sets paths aside: out of the counts and of every reading, and the generation is raised. One that
/// is aside already stays so; one that is retired was out of the counts before. In a writing
/// transaction.
void set_aside_paths(Connection& connection, const std::vector<std::int64_t>& paths);

}  // namespace kinship::store::postgres
