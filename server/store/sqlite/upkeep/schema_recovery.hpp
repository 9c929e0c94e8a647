#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "server/store/sqlite/database/database.hpp"

/// The schema of a damaged store. That of a store always lies on the same pages, so that a new one
/// has it at the same places.
namespace kinship::store {

/// How the schema of a store, and the fixed part of its header, stand to those of a new one, beside
/// what others added.
enum class SchemaState {
  Same,
  Elsewhere,  ///< with other roots: SQLite's VACUUM wrote the store anew, or a root is damaged
  Damaged
};
SchemaState state_of_schema(Database& store, const std::filesystem::path& file, Database& fresh,
                            const std::filesystem::path& fresh_file);

/// A copy of a store, with the schema of a new one, while it lives.
class SchemaCopy {
 public:
  static constexpr std::string_view kSuffix =
      ".source";  ///< of the copy, behind the new store's name

  SchemaCopy(const std::filesystem::path& file, Database& fresh,
             const std::filesystem::path& fresh_file);
  SchemaCopy(const SchemaCopy&) = delete;
  SchemaCopy& operator=(const SchemaCopy&) = delete;
  ~SchemaCopy();

  Database& database() const noexcept { return *database_; }

 private:
  std::filesystem::path file_;
  std::unique_ptr<Database> database_;
};

}  // namespace kinship::store
