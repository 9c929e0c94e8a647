#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/postgres/postgres_store.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// The engine of a store.
enum class StoreKind {
  SqliteFile,        ///< a path
  PostgresDatabase,  ///< postgresql://... or postgres://...
};

/// The engine that the name of a store asks for. \return InvalidInput for any other URL.
Result<StoreKind> kind_of_store(std::string_view name);

/// A store's name without its secret, the password of a URL.
std::string displayed_store(const std::string& name);

struct StoreOptions {
  SqliteOptions sqlite;
  PostgresOptions postgres;
};

/// Opens (or makes) the store of this name.
/// \throws Failure(InvalidInput) if the name is of no store; Failure as the engines say.
std::unique_ptr<Store> open_store(const std::string& name, const StoreOptions& options);

}  // namespace kinship::store
