#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "server/store/sqlite/database/row_checksums.hpp"
#include "server/store/sqlite/database/statement.hpp"

namespace kinship::store {

/// SQL that says whether a row of a table is quarantined (rows/quarantine_rows).
std::string in_quarantine(std::string_view table);

enum class Access {
  ReadOnly,
  AtRest,  ///< ReadOnly of a file that no process writes: no lock, no file beside it
  ReadWrite,
  Create
};

class OnlineBackup;

/// A connection to an SQLite file: the owner of one sqlite3. Used by one thread at a time (it is
/// opened without SQLite's own mutex). Every method throws SqliteError.
class Database : public Session {
 public:
  /// \param access  Create: makes the file if it is missing.
  Database(const std::filesystem::path& file, Access access);
  ~Database() override;

  struct Reset {
    void operator()(Statement* statement) const noexcept { statement->reset(); }
  };
  /// A statement on loan; resets itself when the loan ends, so that it holds no read snapshot.
  using CachedStatement = std::unique_ptr<Statement, Reset>;

  const Dialect& dialect() const noexcept override;
  std::string is_intact(std::string_view table) override;
  std::string is_quarantined(std::string_view table) const override { return in_quarantine(table); }
  void require_absent(std::string_view table, std::string_view column,
                      const Parameter& value) override;

  /// From now on the rows that this connection writes get their checksums.
  void keep_checksums();
  const std::map<std::string, CheckedTable, std::less<>>& checked_tables();
  /// Inserts a row with all columns of a table with checksums.
  /// \param columns  the same in each call; empty: in the order of the table.
  CachedStatement insert_into(std::string_view table, const std::vector<std::string>& columns = {});

  void execute(const std::string& script);     ///< runs statements without parameters, drops rows
  std::int64_t integer(std::string_view sql);  ///< the first column of the first row; 0 if none

  /// The statement for `sql`, prepared once per connection. One loan of the same text at a time.
  CachedStatement cached(std::string_view sql);

  /// The id of the row that the last INSERT made. \throws SqliteError, a constraint, if a trigger
  /// took the row away.
  std::int64_t inserted_id() const;
  std::int64_t changed_rows() const noexcept;  ///< by the last INSERT, UPDATE or DELETE
  bool in_transaction() const noexcept;
  sqlite3& connection() noexcept { return *connection_; }
  /// A backup that reads from this connection, or null; it ends before the connection closes.
  std::unique_ptr<OnlineBackup>& backup() noexcept { return backup_; }

 private:
  Row& run(std::string_view sql, std::span<const Parameter> parameters) override;
  bool try_run(std::string_view sql, std::span<const Parameter> parameters) override;
  bool is_damage(const Failure& failure) const noexcept override;
  /// A text of a table, made once.
  template <typename Make>
  const std::string& text_of(std::map<std::string, std::string, std::less<>>& texts,
                             std::string_view table, Make make);

  struct Close {
    void operator()(sqlite3* connection) const noexcept;
  };
  std::unique_ptr<sqlite3, Close> connection_;
  std::map<std::string, CheckedTable, std::less<>> checked_tables_;  // read when they are needed
  std::map<std::string, std::string, std::less<>> conditions_, inserts_;  // by table
  std::map<std::string, Statement, std::less<>> statements_;  // destroyed before the connection
  std::unique_ptr<OnlineBackup> backup_;                      // and this too
};

}  // namespace kinship::store
