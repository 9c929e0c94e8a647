#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "server/store/postgres/opening/opening.hpp"
#include "tests/support/postgres_cluster.hpp"

namespace kinship::store {

/// One PostgreSQL cluster for a program, with fresh databases of the schema of today.
class FreshDatabases {
 public:
  static FreshDatabases& of_program() {
    static FreshDatabases databases;
    return databases;
  }

  /// The database that stands for a folder: made when it is first asked for. Those of folders that
  /// are gone go too, for each takes some megabytes of memory.
  std::string url(const std::filesystem::path& folder) {
    for (auto each = names_.begin(); each != names_.end();) {
      if (std::filesystem::exists(each->first)) {
        ++each;
        continue;
      }
      cluster_.drop_database(each->second);
      each = names_.erase(each);
    }
    const auto [place, is_new] = names_.try_emplace(folder);
    if (is_new) {
      place->second = "store_" + std::to_string(++count_);
      cluster_.create_database(place->second, "pattern");
    }
    return cluster_.url(place->second);
  }

  const test::PostgresCluster& cluster() const noexcept { return cluster_; }
  const std::string& name(const std::filesystem::path& folder) const { return names_.at(folder); }

 private:
  /// The schema alone: a copy of a store would be noticed as one.
  FreshDatabases() {
    postgres::open_store_connection(postgres::ConnectionString(cluster_.create_database("pattern")),
                                    {});
  }

  test::PostgresCluster cluster_;
  std::map<std::filesystem::path, std::string> names_;
  int count_ = 0;
};

}  // namespace kinship::store
