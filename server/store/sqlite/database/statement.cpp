#include "server/store/sqlite/database/statement.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cstdlib>
#include <variant>

#include "server/store/sqlite/database/sqlite_error.hpp"

namespace kinship::store {

void Statement::Finalize::operator()(sqlite3_stmt* statement) const noexcept {
  sqlite3_finalize(statement);
}

Statement::Statement(sqlite3& connection, std::string_view sql) : connection_(&connection) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v3(connection_, sql.data(), static_cast<int>(sql.size()),
                         SQLITE_PREPARE_PERSISTENT, &statement, nullptr) != SQLITE_OK)
    throw_sqlite_error(connection, sql);
  statement_.reset(statement);
  for (int place = 1; place <= sqlite3_bind_parameter_count(statement); ++place)
    if (const char* const name = sqlite3_bind_parameter_name(statement, place);
        name != nullptr && name[0] == '$') {
      const auto number = static_cast<std::size_t>(std::strtoul(name + 1, nullptr, 10));
      places_.resize(std::max(places_.size(), number + 1));
      places_[number] = place;
    }
}

/// 0, which SQLite refuses, for a number that the statement does not have.
int Statement::place_of(int index) const noexcept {
  const auto number = static_cast<std::size_t>(index);
  if (places_.empty())
    return index;
  return number < places_.size() ? places_[number] : 0;
}

void Statement::check(int code) {
  if (code != SQLITE_OK)
    throw_sqlite_error(*connection_, sqlite3_sql(statement_.get()));
}

Statement& Statement::bind(int index, std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), place_of(index), value));
  return *this;
}

Statement& Statement::bind(int index, double value) {
  check(sqlite3_bind_double(statement_.get(), place_of(index), value));
  return *this;
}

Statement& Statement::bind(int index, std::string_view value) {
  // A null pointer would bind NULL, and the data of an empty view may be one.
  const char* const text = value.empty() ? "" : value.data();
  check(sqlite3_bind_text64(statement_.get(), place_of(index), text, value.size(), SQLITE_TRANSIENT,
                            SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind(int index, Bytes value) {
  check(value.empty() ? sqlite3_bind_zeroblob(statement_.get(), place_of(index), 0)
                      : sqlite3_bind_blob64(statement_.get(), place_of(index), value.data(),
                                            value.size(), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind(int index, std::nullopt_t) {
  check(sqlite3_bind_null(statement_.get(), place_of(index)));
  return *this;
}

Statement& Statement::bind(int index, const Parameter& value) {
  if (value.is_null())
    return bind(index, std::nullopt);
  std::visit([&](const auto& each) { bind(index, each); }, value.value());
  return *this;
}

Statement& Statement::bind_column(int index, const Statement& row, int column) {
  check(sqlite3_bind_value(statement_.get(), place_of(index),
                           sqlite3_column_value(row.statement_.get(), column)));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW)
    return true;
  if (code == SQLITE_DONE)
    return false;
  throw_sqlite_error(*connection_, sqlite3_sql(statement_.get()));
}

void Statement::run() {
  while (step()) {
  }
}

void Statement::reset() noexcept {
  sqlite3_reset(statement_.get());  // repeats the error that step() has thrown already
  sqlite3_clear_bindings(statement_.get());
}

int Statement::columns() const noexcept { return sqlite3_column_count(statement_.get()); }

std::int64_t Statement::column_integer(int column) const noexcept {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::column_real(int column) const noexcept {
  return sqlite3_column_double(statement_.get(), column);
}

std::string_view Statement::column_text(int column) const noexcept {
  const void* const text = sqlite3_column_text(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return text == nullptr ? std::string_view()
                         : std::string_view(static_cast<const char*>(text), size);
}

Bytes Statement::column_blob(int column) const noexcept {
  const void* const blob = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return blob == nullptr ? Bytes() : Bytes(static_cast<const std::uint8_t*>(blob), size);
}

bool Statement::column_is_null(int column) const noexcept {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

}  // namespace kinship::store
