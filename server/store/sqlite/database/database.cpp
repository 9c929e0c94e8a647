#include "server/store/sqlite/database/database.hpp"

#include <sqlite3.h>

#include <stdexcept>

#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"

namespace kinship::store {
namespace {

int open_flags(Access access) {
  switch (access) {
    case Access::ReadOnly:
      return SQLITE_OPEN_READONLY;
    case Access::AtRest:
      return SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    case Access::ReadWrite:
      return SQLITE_OPEN_READWRITE;
    case Access::Create:
      return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  }
  return SQLITE_OPEN_READONLY;
}

/// As SQLite takes the name of a file.
std::string name_of(const std::filesystem::path& file, Access access) {
  if (access != Access::AtRest)
    return file.string();
  std::string uri = "file:";
  for (const char each : std::filesystem::absolute(file).string())
    if (each == '%' || each == '?' || each == '#')
      uri += each == '%' ? "%25" : each == '?' ? "%3f" : "%23";
    else
      uri += each;
  return uri + "?immutable=1";
}

/// Of an index.
struct Entry {
  std::string key;
  std::int64_t id = 0;
  auto operator<=>(const Entry&) const = default;
};

std::string key_of(const Parameter& value) {
  if (const auto* const text = std::get_if<std::string_view>(&value.value()))
    return std::string(*text);
  const Bytes bytes = std::get<Bytes>(value.value());
  return {bytes.begin(), bytes.end()};
}

}  // namespace

void Database::Close::operator()(sqlite3* connection) const noexcept { sqlite3_close(connection); }

Database::Database(const std::filesystem::path& file, Access access) {
  sqlite3* connection = nullptr;
  const int code = sqlite3_open_v2(name_of(file, access).c_str(), &connection,
                                   open_flags(access) | SQLITE_OPEN_NOMUTEX, nullptr);
  connection_.reset(connection);  // SQLite may hand out a connection although it failed
  if (code != SQLITE_OK)
    throw SqliteError(
        code, "store '" + file.string() + "': " +
                  (connection != nullptr ? sqlite3_errmsg(connection) : sqlite3_errstr(code)));
  sqlite3_extended_result_codes(connection, 1);
  sqlite3_db_config(connection, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(connection, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_exec(connection, "PRAGMA temp_store = MEMORY", nullptr, nullptr, nullptr);
  add_checksum_function(*connection);
}

Database::~Database() = default;

std::string in_quarantine(std::string_view table) {
  const std::string name(table);
  return "EXISTS (SELECT 1 FROM quarantine WHERE of_table = '" + name +
         "' AND quarantine.id = " + name + ".id)";
}

const Dialect& Database::dialect() const noexcept {
  static constexpr Dialect kDialect = {
      .newest_attempts_first = "id DESC",
      .quarantine_distribution =
          "INSERT INTO quarantine (of_table, id, noticed_ms) VALUES ('distribution', $1, $2)"
          " ON CONFLICT (of_table, id) DO NOTHING",
      .by_task_robot = " INDEXED BY path_by_task_robot"};
  return kDialect;
}

const std::map<std::string, CheckedTable, std::less<>>& Database::checked_tables() {
  if (checked_tables_.empty())
    checked_tables_ = read_checked_tables(*connection_);
  return checked_tables_;
}

template <typename Make>
const std::string& Database::text_of(std::map<std::string, std::string, std::less<>>& texts,
                                     std::string_view table, Make make) {
  const auto found = texts.find(table);
  if (found != texts.end())
    return found->second;
  const auto checked = checked_tables().find(table);
  if (checked == checked_tables().end())
    throw std::logic_error("table " + std::string(table) + " has no checksums");
  return texts.emplace(table, make(checked->second)).first->second;
}

std::string Database::is_intact(std::string_view table) {
  return text_of(conditions_, table, [&](const CheckedTable& checked) {
    const std::string row = std::string(table) + ".";
    return "(" + row + "row_crc32c IS " + checked.checksum(row) + ")";
  });
}

void Database::require_absent(std::string_view table, std::string_view column,
                              const Parameter& value) {
  const std::string name(table), key(column);
  // A damaged row keeps its entries.
  const std::string fits = "EXISTS (SELECT 1 FROM " + name + " WHERE " + name +
                           ".id = entry.id AND (" + name + "." + key + " IS entry." + key +
                           " OR NOT " + is_intact(table) + "))";
  const std::string next = "SELECT " + key + ", id, " + fits + " FROM " + name + " AS entry WHERE ";
  for (const bool is_rising : {true, false}) {
    Entry before{key_of(value)};
    for (const Row& row :
         query(next + key +
                   (is_rising ? " >= $1 ORDER BY " + key + ", id LIMIT 2"
                              : " <= $1 ORDER BY " + key + " DESC, id DESC LIMIT 2"),
               value)) {
      Entry entry{key_of(Parameter(row.column_blob(0))), row.column_integer(1)};
      if (before.id == 0 && entry.key == before.key)
        return;
      if (row.column_integer(2) == 0 || (is_rising ? entry <= before : before <= entry))
        throw damaged_row("an index of table " + name);
      before = std::move(entry);
    }
  }
}

void Database::keep_checksums() {
  checked_tables_ = read_checked_tables(*connection_);
  conditions_.clear();
  inserts_.clear();
  execute(checksum_triggers(checked_tables_));
}

Database::CachedStatement Database::insert_into(std::string_view table,
                                                const std::vector<std::string>& columns) {
  return cached(text_of(inserts_, table, [&](const CheckedTable& checked) {
    return insert_with_checksum(std::string(table), checked,
                                columns.empty() ? checked.columns : columns);
  }));
}

Row& Database::run(std::string_view sql, std::span<const Parameter> parameters) {
  CachedStatement statement = cached(sql);
  int index = 0;
  for (const Parameter& parameter : parameters)
    statement->bind(++index, parameter);
  return *statement.release();
}

bool Database::try_run(std::string_view sql, std::span<const Parameter> parameters) {
  return unless_damaged([&] {
    Savepoint part(*this);
    query_with(sql, parameters);
    part.keep();
    return true;
  });
}

bool Database::is_damage(const Failure& failure) const noexcept {
  const auto* const error = dynamic_cast<const SqliteError*>(&failure);
  return error != nullptr && error->is_damage();
}

void Database::execute(const std::string& script) {
  if (sqlite3_exec(connection_.get(), script.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    throw_sqlite_error(*connection_, script);
}

std::int64_t Database::integer(std::string_view sql) {
  Statement statement(*connection_, sql);
  return statement.step() ? statement.column_integer(0) : 0;
}

Database::CachedStatement Database::cached(std::string_view sql) {
  auto found = statements_.find(sql);
  if (found == statements_.end())
    found = statements_.emplace(std::string(sql), Statement(*connection_, sql)).first;
  return CachedStatement(&found->second);
}

std::int64_t Database::inserted_id() const {
  if (changed_rows() != 1)
    throw SqliteError(SQLITE_CONSTRAINT_TRIGGER, "a trigger of the store took a row away");
  return sqlite3_last_insert_rowid(connection_.get());
}

std::int64_t Database::changed_rows() const noexcept {
  return sqlite3_changes64(connection_.get());
}

bool Database::in_transaction() const noexcept {
  return sqlite3_get_autocommit(connection_.get()) == 0;
}

}  // namespace kinship::store
