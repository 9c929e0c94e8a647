#include "server/store/moving/side.hpp"

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/rows/damage_search.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store::moving {
namespace {

namespace fs = std::filesystem;

std::string joined_with_commas(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string selected_columns(const MovedTable& table) {
  std::vector<std::string> columns;
  for (const MovedColumn& column : table.columns)
    columns.push_back(column.sqlite.empty() ? column.name : column.sqlite);
  return joined_with_commas(columns);
}

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

SqliteScenes::SqliteScenes(Database& database) {
  const auto query = database.cached(
      "SELECT id, replaced_by FROM quarantine WHERE of_table = 'scene' AND replaced_by > id ORDER "
      "BY id");
  while (query->step())
    replaced_by_[query->column_integer(0)] = query->column_integer(1);
  for (const auto& [id, next] : replaced_by_)
    first_.emplace(last_of(id), id);  // by falling age: the first that leads there stays
}

std::int64_t SqliteScenes::last_of(std::int64_t id) const {
  // A row is replaced by a later one, so this ends.
  for (auto next = replaced_by_.find(id); next != replaced_by_.end(); next = replaced_by_.find(id))
    id = next->second;
  return id;
}

std::int64_t SqliteScenes::first_of(std::int64_t id) const {
  const std::int64_t last = last_of(id);
  const auto found = first_.find(last);
  return found == first_.end() ? last : found->second;
}

void bind_cell(Statement& statement, int index, const Cell& cell, CellType type) {
  if (const auto* const integer = std::get_if<std::int64_t>(&cell))
    statement.bind(index, *integer);
  else if (const auto* const real = std::get_if<double>(&cell))
    statement.bind(index, *real);
  else if (const auto* const text = std::get_if<std::string>(&cell); text == nullptr)
    statement.bind(index, std::nullopt);
  else if (type == CellType::Text)
    statement.bind(index, std::string_view(*text));
  else
    statement.bind(index, Bytes(reinterpret_cast<const std::uint8_t*>(text->data()), text->size()));
}

/// INSERT of the columns that are the table's own; one that is never changed in place is not
/// replaced, which the triggers of the audit log would refuse.
std::string upsert_into(const MovedTable& table) {
  std::vector<std::string> names, places, keys, changes;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const MovedColumn& column = table.columns[i];
    if (column.is_of_quarantine)
      continue;
    names.push_back(column.name);
    places.emplace_back("?");
    if (i < table.keys)
      keys.push_back(column.name);
    else
      changes.push_back(column.name + " = excluded." + column.name);
  }
  std::string sql = "INSERT INTO " + table.name + " (" + joined_with_commas(names) + ") VALUES (" +
                    joined_with_commas(places) + ")";
  if (table.name != "audit")
    sql += " ON CONFLICT (" + joined_with_commas(keys) + ") DO UPDATE SET " +
           joined_with_commas(changes);
  return sql;
}

class SqliteSide : public Side {
 public:
  SqliteSide(const fs::path& file, bool is_target)
      : file_(file), name_(file.string()), is_target_(is_target) {}
  ~SqliteSide() override { database_.reset(); }

  /// Of a source. A reader that ends leaves the WAL alone: it may be the server's.
  void open_source() {
    static_cast<void>(served_by());
    open_beside();
    named([&] {
      // A copy would have a checksum of the damaged row.
      if (const std::optional<std::string> damaged = find_damaged_row(*database_))
        throw damaged_row(*damaged);
    });
  }

  void open_target() {
    lock_.emplace(file_);
    if (!fs::exists(file_))
      make_empty_store();
    named([&] {
      make_wal_durable(file_);
      database_ = open_migrated(file_, embedded_migrations());
      // Writes of the last seconds that a power cut takes are copied again.
      database_->execute("PRAGMA synchronous = NORMAL");
    });
    files::sync_folder_of(file_);
  }

  const std::string& name() const override { return name_; }
  std::string identity() override { return name_; }  // canonical
  Uuid epoch() override { return Uuid::parse(setting("epoch")).value_or(Uuid{}); }

  void in_snapshot(const std::function<void()>& read) override {
    named([&] {
      const Transaction snapshot(*database_, Transaction::Kind::Read);
      read();
    });
  }

  std::vector<MovedRow> of_ids(const MovedTable& table,
                               std::span<const std::int64_t> ids) override {
    std::vector<MovedRow> rows;
    named([&] {
      const SqliteScenes scenes(*database_);
      const bool is_scene = table.name == "scene";
      const auto query = database_->cached("SELECT " + selected_columns(table) + " FROM " +
                                           table.name + " WHERE id = ?");
      for (const std::int64_t id : ids) {
        if (query->bind(1, is_scene ? scenes.last_of(id) : id).step()) {
          MovedRow& row = rows.emplace_back(read_row(*query, table));
          if (is_scene)
            row.front() = id;
          else
            name_first_scene(table, row, scenes);
        }
        query->reset();
      }
    });
    return rows;
  }

  std::vector<RowFingerprint> light(const MovedTable& table, const Pair& pair) override {
    std::vector<RowFingerprint> rows = Side::light(table, pair);
    if (table.name == "scene") {
      const SqliteScenes scenes(*database_);
      for (RowFingerprint& row : rows)
        row[0] = scenes.first_of(row[0]);
    }
    std::ranges::sort(rows);
    return rows;
  }

  std::string served_by() override {
    if (lock_)
      return {};
    const bool was_open = database_ != nullptr;
    database_.reset();  // a lock in vain closes the file, which would drop SQLite's locks on it
    try {
      lock_.emplace(file_);
    } catch (const Failure& failure) {
      if (failure.code() != ErrorCode::Unavailable)
        throw;
      if (was_open)
        open_beside();
      return failure.what();
    }
    // A WAL that a server left is read once it is on the disk.
    make_wal_durable(file_);
    open_beside();
    return {};
  }

  std::string writes_seen() override { return {}; }  // the lock keeps others out

  bool has_content() override { return !setting("epoch").empty() || Side::has_content(); }

  void in_transaction(const std::function<void()>& write) override {
    if (is_target_)
      return named([&] { in_transaction_of(*database_, write); });
    // Of a source only its mark is written, and only while no server has it open.
    if (!lock_)
      throw Failure(ErrorCode::Unavailable, "store '" + name_ + "': a server has it open");
    database_.reset();
    database_ = std::make_unique<Database>(file_, Access::ReadWrite);
    database_->execute("PRAGMA synchronous = FULL");
    database_->keep_checksums();
    in_transaction_of(*database_, write);
    database_.reset();
    open_beside();
  }

  void in_last_transaction(const std::function<void()>& write) override {
    if (!is_target_)
      return in_transaction(write);
    named([&] { database_->execute("PRAGMA synchronous = FULL"); });
    in_transaction(write);
    bool is_whole = false;
    named([&] { is_whole = checkpoint(*database_, CheckpointKind::Whole); });
    if (!is_whole)
      throw Failure(ErrorCode::Storage,
                    "store '" + name_ + "': another program reads it and keeps its WAL");
  }

  void claim() override {}  // the lock is the claim

  void write(const MovedTable& table, std::span<const MovedRow> rows) override {
    const auto upsert = database_->cached(upsert_into(table));
    for (const MovedRow& row : rows) {
      int index = 0;
      for (std::size_t i = 0; i < row.size(); ++i)
        if (!table.columns[i].is_of_quarantine)
          bind_cell(*upsert, ++index, row[i], table.columns[i].type);
      upsert->run();
      upsert->reset();
      if (table.has_quarantine)
        write_quarantine(table, row);
    }
  }

  void erase(const MovedTable& table, std::span<const MovedRow> rows) override {
    std::string condition;
    for (std::size_t i = 0; i < table.keys; ++i)
      condition += (i == 0 ? "" : " AND ") + table.columns[i].name + " = ?";
    const auto erase = database_->cached("DELETE FROM " + table.name + " WHERE " + condition);
    for (const MovedRow& row : rows) {
      for (std::size_t i = 0; i < table.keys; ++i)
        bind_cell(*erase, static_cast<int>(i) + 1, row[i], table.columns[i].type);
      erase->run();
      erase->reset();
    }
  }

  void complete() override {
    write_new_epoch(*database_, file_, Uuid::parse(setting(kMovedFrom)).value_or(Uuid{}));
    database_->execute(
        "DELETE FROM setting WHERE key LIKE '" + std::string(kPairRecord) +
        "%';"
        "DELETE FROM same_content;"
        "INSERT INTO same_content (path_id, report_uuid) SELECT path_id, report_uuid FROM attempt"
        " WHERE status = 2 AND path_id IS NOT NULL");
    note_lost_attempts(*database_);
  }

  void remove_all() override {
    database_.reset();
    for (const char* const sidecar : kSidecars)
      unlink((name_ + sidecar).c_str());
    unlink((name_ + ".high-water-mark").c_str());
    if (unlink(name_.c_str()) != 0)
      refuse_store(file_, "cannot be removed");
    unlink((name_ + ".lock").c_str());  // without the file it would say that the store is gone
    files::sync_folder_of(file_);
  }

 private:
  void open_beside() {
    database_ = open_reader(file_);
    sqlite3_db_config(&database_->connection(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  }

  static void in_transaction_of(Database& database, const std::function<void()>& write) {
    Transaction transaction(database, Transaction::Kind::Write);
    write();
    transaction.commit();
  }

  Selection selection_of(const MovedTable& table) const override {
    const std::string& condition = table.sqlite_condition;
    return {selected_columns(table), table.sqlite_from.empty() ? table.name : table.sqlite_from,
            condition.empty() ? "TRUE" : condition, table.sqlite_light};
  }
  Database& session() override { return *database_; }
  std::optional<Failure> naming_store(const Failure& failure) const override {
    const auto* const error = dynamic_cast<const SqliteError*>(&failure);
    if (error == nullptr)
      return std::nullopt;
    return Failure(ErrorCode::Storage,
                   "store '" + name_ + "': " + error->what() +
                       (error->is_damage() ? "; a part of it is damaged and cannot be moved: stop "
                                             "its server, 'kinshipd repair --store " +
                                                 name_ + "', then go on"
                                           : ""));
  }

  /// Whole or not at all: a retry after a full disk finds no half of a schema.
  void make_empty_store() const {
    named([&] {
      files::NewFile file(file_, kNewDatabase);
      checkpoint(*open_migrated(file.part(), embedded_migrations()), CheckpointKind::Whole);
      file.publish();
    });
  }

  static void name_first_scene(const MovedTable& table, MovedRow& row, const SqliteScenes& scenes) {
    for (std::size_t i = 0; i < row.size(); ++i)
      if (table.columns[i].name == "scene_id" && integer_of(row, i) != 0)
        row[i] = scenes.first_of(integer_of(row, i));
  }

  void write_quarantine(const MovedTable& table, const MovedRow& row) {
    const std::size_t damaged = table.column("damaged_ms");
    if (integer_of(row, damaged) == 0) {
      database_->cached("DELETE FROM quarantine WHERE of_table = ? AND id = ?")
          ->bind_all(std::string_view(table.name), integer_of(row, 0))
          .run();
      return;
    }
    const bool is_path = table.name == "path";
    const auto insert = database_->cached(
        "INSERT OR REPLACE INTO quarantine (of_table, id, noticed_ms, replaced_by, retired_ms)"
        " VALUES (?, ?, ?, ?, ?)");
    insert->bind_all(std::string_view(table.name), integer_of(row, 0), integer_of(row, damaged));
    constexpr int kReplacedBy = 4, kRetired = 5;
    if (is_path) {
      bind_cell(*insert, kReplacedBy, row[table.column("replaced_by")], CellType::Integer);
      bind_cell(*insert, kRetired, row[table.column("retired_ms")], CellType::Integer);
    }
    insert->run();
  }

  const fs::path file_;
  const std::string name_;
  const bool is_target_;
  std::optional<StoreLock> lock_;
  std::unique_ptr<Database> database_;
};

}  // namespace

std::unique_ptr<Side> open_sqlite_source(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error))
    throw Failure(ErrorCode::NotFound, "store '" + file.string() + "': there is no such file");
  const fs::path located = locate_store(file);
  {
    const std::unique_ptr<Database> database = open_reader(located);
    sqlite3_db_config(&database->connection(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    check_schema(*database, located, embedded_migrations());
  }
  auto side = std::make_unique<SqliteSide>(located, false);
  side->open_source();
  return side;
}

std::unique_ptr<Side> open_sqlite_target(const fs::path& file) {
  auto side = std::make_unique<SqliteSide>(locate_servable(file), true);
  side->open_target();
  return side;
}

}  // namespace kinship::store::moving
