#include "server/store/postgres/copying/sqlite_copy.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/postgres/database/transaction.hpp"
#include "server/store/sqlite/database/online_backup.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store::postgres {
namespace {

constexpr double kShareOfRows = 0.9;  // of the progress; the rest is writing the file

/// A table of SQLite and the place of its rows. It comes after the tables that it refers to.
struct CopiedTable {
  std::string name;
  bool has_id = true;  ///< by which it is read in parts; others are small
  std::string condition = "TRUE";
  std::string source = name;
};

const std::vector<CopiedTable>& copied_tables() {
  static const std::vector<CopiedTable> tables = {
      {"robot"},
      {"robot_held_joint", false},
      {"robot_never_colliding", false},
      {"robot_geometry", false},
      {"task"},
      {"experience", false},
      {"scene"},
      {"path"},
      {"attempt"},
      {"distribution"},
      {"distribution_use"},
      {"evicted_distribution", false},
      {"rehearsal"},
      {"search"},
      {"mesh"},
      {"audit"},
      {"setting", false, "key = 'revision_floor'"},
      {"retired_report"},
      {"same_content", true, "status = 2 AND path_id IS NOT NULL", "attempt"}};
  return tables;
}

/// A column as SQLite declares it.
struct Column {
  std::string name;
  std::string type;
};

std::vector<Column> columns_of(Database& target, const std::string& table) {
  Statement query(target.connection(),
                  "SELECT name, type FROM pragma_table_info(?) WHERE name <> 'row_crc32c'");
  query.bind(1, std::string_view(table));
  std::vector<Column> columns;
  while (query.step())
    columns.push_back({std::string(query.column_text(0)), std::string(query.column_text(1))});
  return columns;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// Copies the rows of a store that is read in one snapshot into a database that is in a
/// transaction.
class RowCopy {
 public:
  RowCopy(Connection& source, Database& target, const std::function<bool(double)>& progress)
      : source_(&source), target_(&target), progress_(&progress), rows_(count_rows()) {}

  /// \return false if the progress ended it.
  bool copy_all() {
    for (const CopiedTable& table : copied_tables())
      if (!copy(table))
        return false;
    copy_damage();
    note_lost_attempts(*target_);
    return true;
  }

 private:
  /// About, for the progress.
  std::int64_t count_rows() const {
    return source_->query("SELECT coalesce(sum(attempts + paths), 0)::bigint FROM experience")
        .front()
        .column_integer(0);
  }

  bool copy(const CopiedTable& table) {
    const std::vector<Column> columns = columns_of(*target_, table.name);
    if (columns.empty())
      return true;  // nothing that SQLite's schema knows
    std::vector<std::string> names, places;
    for (const Column& column : columns) {
      names.push_back(column.name);
      places.emplace_back("?");
    }
    Statement insert(target_->connection(), "INSERT INTO " + table.name + " (" + joined(names) +
                                                ") VALUES (" + joined(places) + ")");
    const std::string rest = " FROM " + table.source + " WHERE " + table.condition;
    const std::string select = "SELECT " + joined(names);
    if (!table.has_id) {
      insert_all(insert, columns, source_->query(select + rest));
      return true;
    }
    constexpr std::int64_t kRowsAtOnce = 64;  // of 4 MB at most
    std::int64_t last_id = 0;
    while (true) {
      const Rows rows = source_->query(select + ", id" + rest + " AND id > $1 ORDER BY id LIMIT $2",
                                       last_id, kRowsAtOnce);
      if (rows.empty())
        return true;
      insert_all(insert, columns, rows);
      last_id = rows[rows.size() - 1].column_integer(static_cast<int>(columns.size()));
      copied_ += rows.size();
      const double part =  // 1 at most, and never less than before, also by its last bit
          static_cast<double>(copied_) / static_cast<double>(std::max(rows_, copied_));
      if (!(*progress_)(kShareOfRows * part))
        return false;
    }
  }

  static void insert_all(Statement& insert, const std::vector<Column>& columns, const Rows& rows) {
    for (const Row row : rows) {
      for (int column = 0; column < static_cast<int>(columns.size()); ++column)
        bind(insert, column, columns[static_cast<std::size_t>(column)].type, row);
      insert.run();
      insert.reset();
    }
  }

  static void bind(Statement& insert, int column, const std::string& type, const Row& row) {
    if (row.column_is_null(column))
      insert.bind(column + 1, std::nullopt);
    else if (type == "INTEGER")
      insert.bind(column + 1, row.column_integer(column));
    else if (type == "REAL")
      insert.bind(column + 1, row.column_real(column));
    else if (type == "TEXT")
      insert.bind(column + 1, row.column_text(column));
    else
      insert.bind(column + 1, row.column_blob(column));
  }

  /// Marks of damage are columns in PostgreSQL and a table of its own in SQLite.
  void copy_damage() {
    Statement insert(target_->connection(),
                     "INSERT INTO quarantine (of_table, id, noticed_ms, replaced_by, retired_ms)"
                     " VALUES (?, ?, ?, ?, ?)");
    const std::vector<Column> columns = columns_of(*target_, "quarantine");
    insert_all(insert, columns,
               source_->query("SELECT 'path', id, damaged_ms, replaced_by, retired_ms FROM path "
                              "WHERE damaged_ms IS NOT NULL"));
    insert_all(insert, columns,
               source_->query("SELECT 'scene', id, damaged_ms, NULL::bigint, NULL::bigint FROM "
                              "scene WHERE damaged_ms IS NOT NULL"));
  }

  Connection* source_;
  Database* target_;
  const std::function<bool(double)>* progress_;
  std::int64_t rows_;
  std::int64_t copied_ = 0;
};

/// \param file  that the store is going to be.
/// \return false if the progress ended it.
bool fill(Connection& source, Database& target, const std::filesystem::path& file,
          const std::function<bool(double)>& progress) {
  target.execute("PRAGMA synchronous = OFF");  // it has no name yet
  const Transaction snapshot(source, Transaction::Kind::Snapshot);
  store::Transaction all(target, store::Transaction::Kind::Write);
  if (!RowCopy(source, target, progress).copy_all())
    return false;
  const Rows epoch = source.query("SELECT epoch FROM epoch ORDER BY number DESC LIMIT 1");
  write_new_epoch(target, file, epoch.empty() ? Uuid{} : id_of<Uuid>(epoch.front().column_blob(0)));
  all.commit();
  return true;
}

}  // namespace

Result<bool> copy_to_sqlite(Connection& connection, const std::filesystem::path& file,
                            const std::function<bool(double)>& progress) {
  try {
    files::NewFile target(file, kNewDatabase);
    const files::NewFile rows(file.string() + ".rows", kNewDatabase);
    {
      const std::unique_ptr<Database> database =
          open_migrated(rows.part(), store::embedded_migrations(), Keep::Nothing);
      if (!fill(connection, *database, target.part(), progress))
        return false;
      copy_database(*database, target.part(), [](double) {});
    }
    if (!progress(1))
      return false;
    target.publish();
    return true;
  } catch (const Failure& failure) {
    if (failure.code() == ErrorCode::Conflict)
      return failure.error();
    throw Failure(failure.code(), "backup '" + file.string() + "': " + failure.what());
  }
}

}  // namespace kinship::store::postgres
