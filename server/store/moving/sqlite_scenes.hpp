#pragma once

#include <cstdint>
#include <map>

#include "server/store/sqlite/database/database.hpp"

namespace kinship::store::moving {

/// Scenes of an SQLite store that were damaged and came again, under a new id, as one each: under
/// its first id, with the content of the last.
class SqliteScenes {
 public:
  explicit SqliteScenes(Database& database);

  std::int64_t first_of(std::int64_t id) const;
  std::int64_t last_of(std::int64_t id) const;

 private:
  std::map<std::int64_t, std::int64_t> replaced_by_;
  std::map<std::int64_t, std::int64_t> first_;  // of the last ones
};

}  // namespace kinship::store::moving
