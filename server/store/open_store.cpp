#include "server/store/open_store.hpp"

#include <algorithm>
#include <cctype>

#include "server/store/postgres/database/connection_string.hpp"

namespace kinship::store {
namespace {

/// "mysql" of "mysql://host/x"; empty if it is no URL.
std::string_view scheme_of(std::string_view name) {
  const std::size_t end = name.find("://");
  if (end == std::string_view::npos || end == 0)
    return {};
  const std::string_view scheme = name.substr(0, end);
  const bool is_scheme = std::ranges::all_of(scheme, [](unsigned char each) {
    return std::isalnum(each) != 0 || each == '+' || each == '-' || each == '.';
  });
  return is_scheme ? scheme : std::string_view();
}

}  // namespace

Result<StoreKind> kind_of_store(std::string_view name) {
  if (postgres::is_connection_string(name))
    return StoreKind::PostgresDatabase;
  if (const std::string_view scheme = scheme_of(name); !scheme.empty())
    return invalid_input("store: '" + std::string(scheme) +
                         "://' is not known; a store is the path of a file (SQLite) or "
                         "postgresql://USER@HOST:PORT/DATABASE");
  return StoreKind::SqliteFile;
}

std::string displayed_store(const std::string& name) {
  if (!postgres::is_connection_string(name))
    return name;
  try {
    return postgres::ConnectionString(name).description();
  } catch (const Failure&) {
    return "postgresql://...";
  }
}

std::unique_ptr<Store> open_store(const std::string& name, const StoreOptions& options) {
  if (kind_of_store(name).value_or_throw() == StoreKind::PostgresDatabase)
    return open_postgres_store(name, options.postgres);
  return open_sqlite_store(name, options.sqlite);
}

}  // namespace kinship::store
