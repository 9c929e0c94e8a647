#include "server/store/report_digests.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>

#include "proto/types/failure.hpp"
#include "server/store/open_store.hpp"
#include "server/store/postgres/database/transaction.hpp"
#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/postgres/rows/arrivals.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/rows/attempt_rows.hpp"
#include "server/store/sqlite/rows/export_rows.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

class SqliteDigests : public ReportDigests {
 public:
  explicit SqliteDigests(const fs::path& file)
      : file_(file), had_wal_(has_wal()), database_(open_unchanged(file)) {
    check_schema(*database_, file, embedded_migrations());
  }

  Feed<ArrivedReport> list_arrivals(std::string_view cursor, std::size_t limit) override {
    auto feed = page_of_arrivals(*database_, "", cursor, limit);
    require_as_opened();
    return feed;
  }

  std::map<Uuid, std::optional<Digest>> known_reports(std::span<const Uuid> reports) override {
    std::map<Uuid, std::optional<Digest>> known;
    for (const Uuid& report : reports) {
      const ReportRows rows = find_report(*database_, report);
      if (rows.row)
        known[report] = body_of(*rows.row);
      else if (!rows.damaged.empty())
        known[report] = std::nullopt;
    }
    require_as_opened();
    return known;
  }

 private:
  std::optional<Digest> body_of(std::int64_t id) {
    const auto query = database_->cached("SELECT body_sha256 FROM attempt WHERE id = ? AND " +
                                         database_->is_intact("attempt"));
    return query->bind(1, id).step() ? std::optional(id_of<Digest>(query->column_blob(0)))
                                     : std::nullopt;
  }

  bool has_wal() const { return fs::exists(file_.string() + "-wal"); }
  /// A store at rest is read without locks.
  void require_as_opened() const {
    if (!had_wal_ && has_wal())
      throw Failure(
          ErrorCode::Unavailable,
          "store '" + file_.string() + "': another program opened it meanwhile; try again");
  }

  const fs::path file_;
  const bool had_wal_;
  const std::unique_ptr<Database> database_;
};

class PostgresDigests : public ReportDigests {
 public:
  explicit PostgresDigests(const std::string& url)
      : primary_(postgres::ConnectionString(url), {.patience = std::chrono::seconds(120)}),
        connection_(primary_.connect()) {
    const std::string prefix = "store '" + primary_.description() + "': ";
    const postgres::Transaction snapshot = begin();
    if (connection_->query("SELECT to_regclass('schema_migration') IS NULL")
            .front()
            .column_integer(0) != 0)
      throw Failure(ErrorCode::NotFound, prefix + "there is no store in it");
    if (const std::int64_t version = postgres::schema_of(*connection_),
        newest = std::ssize(postgres::embedded_migrations());
        version != newest)
      throw Failure(ErrorCode::Storage, prefix + "has schema " + std::to_string(version) +
                                            " instead of " + std::to_string(newest));
  }

  Feed<ArrivedReport> list_arrivals(std::string_view cursor, std::size_t limit) override {
    const postgres::Transaction snapshot = begin();
    return postgres::feed_of_arrivals(*connection_, "", cursor, limit);
  }

  std::map<Uuid, std::optional<Digest>> known_reports(std::span<const Uuid> reports) override {
    const postgres::Transaction snapshot = begin();
    const std::map<Uuid, Digest> known = postgres::select_known(*connection_, reports);
    return {known.begin(), known.end()};
  }

 private:
  /// Whatever is run in it, the database refuses a write.
  postgres::Transaction begin() {
    return postgres::Transaction(*connection_, postgres::Transaction::Kind::Snapshot);
  }

  postgres::Primary primary_;
  const std::unique_ptr<postgres::Connection> connection_;
};

}  // namespace

std::unique_ptr<ReportDigests> open_report_digests(const std::string& name) {
  if (kind_of_store(name).value_or_throw() == StoreKind::PostgresDatabase)
    return std::make_unique<PostgresDigests>(name);
  std::error_code error;
  if (!fs::exists(name, error))
    throw Failure(ErrorCode::NotFound, "store '" + name + "': there is none");
  return std::make_unique<SqliteDigests>(locate_store(name));
}

}  // namespace kinship::store
