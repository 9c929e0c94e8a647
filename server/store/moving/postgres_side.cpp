#include "server/store/moving/side.hpp"

#include <chrono>
#include <utility>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/transaction.hpp"
#include "server/store/postgres/opening/history.hpp"
#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store::moving {
namespace {

constexpr std::string_view kClaim = "moving_run";
constexpr std::string_view kArrival = "moving_arrival";  // the transaction that all rows came in

/// The elements of an array of one type. Texts and reals are never NULL in these tables.
template <typename Element, typename Make>
std::vector<Element> elements_of(std::span<const MovedRow> rows, std::size_t column, Make make) {
  std::vector<Element> elements;
  elements.reserve(rows.size());
  for (const MovedRow& row : rows)
    elements.push_back(make(row[column]));
  return elements;
}

std::optional<std::int64_t> integer_in(const Cell& cell) {
  const auto* const value = std::get_if<std::int64_t>(&cell);
  return value == nullptr ? std::nullopt : std::optional(*value);
}

std::optional<Bytes> bytes_in(const Cell& cell) {
  const auto* const value = std::get_if<std::string>(&cell);
  if (value == nullptr)
    return std::nullopt;
  return Bytes(reinterpret_cast<const std::uint8_t*>(value->data()), value->size());
}

/// "bigint[]" for integers.
const char* array_type_of(CellType type) {
  switch (type) {
    case CellType::Integer:
      return "bigint[]";
    case CellType::Real:
      return "double precision[]";
    case CellType::Text:
      return "text[]";
    case CellType::Blob:
      break;
  }
  return "bytea[]";
}

/// Adds a column of rows as one array.
void add_column(postgres::Parameters& parameters, std::span<const MovedRow> rows,
                std::size_t column, CellType type) {
  switch (type) {
    case CellType::Integer:
      parameters.add(elements_of<std::optional<std::int64_t>>(rows, column, integer_in));
      return;
    case CellType::Real:
      parameters.add(elements_of<double>(rows, column,
                                         [](const Cell& cell) { return std::get<double>(cell); }));
      return;
    case CellType::Text:
      parameters.add(elements_of<std::string>(
          rows, column, [](const Cell& cell) { return std::get<std::string>(cell); }));
      return;
    case CellType::Blob:
      parameters.add(elements_of<std::optional<Bytes>>(rows, column, bytes_in));
      return;
  }
}

/// "unnest($1::bigint[], $2::bytea[])" of the first columns.
std::string unnested(const MovedTable& table, std::size_t count) {
  std::string text = "unnest(";
  for (std::size_t i = 0; i < count; ++i)
    text += std::string(i == 0 ? "$" : ", $") + std::to_string(i + 1) +
            "::" + array_type_of(table.columns[i].type);
  return text + ")";
}

/// As the other engine's; all rows arrive in one transaction, so that ids alone order rows from
/// elsewhere.
std::string upsert_sql(const MovedTable& table) {
  const std::size_t columns = table.columns.size();
  const std::string arrival = "$" + std::to_string(columns + 1) + "::text::xid8";
  std::string sql = "INSERT INTO " + table.name + " (" + listed(table, columns) +
                    (table.is_in_arrival ? ", arrived_in" : "") + ") SELECT moved.*" +
                    (table.is_in_arrival ? ", " + arrival : "") + " FROM " +
                    unnested(table, columns) + " AS moved";
  if (table.name == "audit")
    return sql;
  sql += " ON CONFLICT (" +
         (table.name == "retired_report" ? "report_uuid" : listed(table, table.keys)) +
         ") DO UPDATE SET ";
  for (std::size_t i = table.keys; i < columns; ++i)
    sql += (i == table.keys ? "" : ", ") + table.columns[i].name + " = excluded." +
           table.columns[i].name;
  return sql;
}

class PostgresSide : public Side {
 public:
  explicit PostgresSide(const std::string& url)
      : primary_(postgres::ConnectionString(url), {.patience = std::chrono::seconds(120)}),
        name_(primary_.description()),
        connection_(primary_.connect()) {}

  bool has_store() {
    return run("SELECT to_regclass('schema_migration') IS NOT NULL").front().column_integer(0) != 0;
  }
  void bring_schema() { postgres::migrate(*connection_, postgres::embedded_migrations()); }

  const std::string& name() const override { return name_; }

  /// Tables lie in the schema that `search_path` names first.
  std::string identity() override {
    return "database " + postgres::identity_of(*connection_) + "/" +
           std::string(run("SELECT current_schema()").front().column_text(0));
  }

  Uuid epoch() override {
    const postgres::Rows rows = run("SELECT epoch FROM epoch ORDER BY number DESC LIMIT 1");
    return rows.empty() ? Uuid{} : id_of<Uuid>(rows.front().column_blob(0));
  }

  void in_snapshot(const std::function<void()>& read) override {
    const postgres::Transaction snapshot(*connection_, postgres::Transaction::Kind::Snapshot);
    read();
  }

  std::vector<MovedRow> of_ids(const MovedTable& table,
                               std::span<const std::int64_t> ids) override {
    std::vector<MovedRow> rows;
    for (const postgres::Row row : run("SELECT " + listed(table, table.columns.size()) + " FROM " +
                                           table.name + " WHERE id = ANY($1) ORDER BY id",
                                       std::vector<std::int64_t>(ids.begin(), ids.end())))
      rows.push_back(read_row(row, table));
    return rows;
  }

  std::string served_by() override {
    std::string servers;
    for (const postgres::Row row :
         run("SELECT name, ceil(extract(epoch FROM alive_until - now()))::bigint FROM server"
             " WHERE alive_until > now() ORDER BY name, run"))
      servers += (servers.empty() ? "" : ", ") + std::string(row.column_text(0)) +
                 " (unless it ended less than 6 s ago: then it counts for another " +
                 std::to_string(row.column_integer(1)) + " s)";
    return servers.empty() ? ""
                           : "store '" + name_ + "' is open in servers, from addresses " + servers;
  }

  /// Each transaction of reports raises the position of a run.
  std::string writes_seen() override {
    return std::string(run("SELECT count(*)::text || ' ' || coalesce(sum(position), 0)::text"
                           " FROM run")
                           .front()
                           .column_text(0));
  }

  void in_transaction(const std::function<void()>& write) override {
    in_one(postgres::Transaction::Kind::Local, write);
  }
  /// It waits for a standby, and with it for all before.
  void in_last_transaction(const std::function<void()>& write) override {
    in_one(postgres::Transaction::Kind::Write, write);
  }

  void claim() override {
    claim_.clear();
    const std::string mine = Uuid::random().text();
    in_transaction([&] {
      put_setting(kClaim, mine);
      if (setting(kArrival).empty())
        put_setting(kArrival,
                    std::string(run("SELECT pg_current_xact_id()::text").front().column_text(0)));
    });
    claim_ = mine;
    arrival_ = setting(kArrival);
  }

  void write(const MovedTable& table, std::span<const MovedRow> rows) override {
    postgres::Parameters parameters;
    for (std::size_t column = 0; column < table.columns.size(); ++column)
      add_column(parameters, rows, column, table.columns[column].type);
    if (table.is_in_arrival)
      parameters.add(arrival_);
    run(upsert_sql(table), parameters);
  }

  void erase(const MovedTable& table, std::span<const MovedRow> rows) override {
    postgres::Parameters parameters;
    for (std::size_t column = 0; column < table.keys; ++column)
      add_column(parameters, rows, column, table.columns[column].type);
    const std::string keys = listed(table, table.keys);
    run("DELETE FROM " + table.name + " WHERE (" + keys + ") IN (SELECT * FROM " +
            unnested(table, table.keys) + ")",
        parameters);
  }

  /// Ids of later rows follow the moved ones.
  void complete() override {
    for (const MovedTable& table : moved_tables())
      if (table.columns.front().name == "id" && table.name != "distribution_use")
        run("SELECT setval(pg_get_serial_sequence('" + table.name +
            "', 'id'), greatest((SELECT max(id) FROM " + table.name +
            "), 1), EXISTS (SELECT FROM " + table.name + "))");
    run("DELETE FROM setting WHERE key LIKE '" + std::string(kPairRecord) + "%'");
    put_setting(kClaim, std::nullopt);
    put_setting(kArrival, std::nullopt);
  }

  /// Our tables, and with them that this is one of ours: a move begins anew with the schema.
  void remove_all() override {
    claim_.clear();
    in_transaction([&] {
      connection_->execute(
          "DROP TABLE IF EXISTS audit, fit_lease, server, mesh, search, rehearsal, "
          "evicted_distribution,"
          " distribution_use, distribution, retired_report, attempt, path, scene, experience, task,"
          " former_task,"
          " robot_geometry, robot_never_colliding, robot_held_joint, gone_robot, robot, run, epoch,"
          " setting, schema_migration; DROP FUNCTION IF EXISTS audit_is_append_only()");
    });
  }

 private:
  Selection selection_of(const MovedTable& table) const override {
    const std::string& condition = table.postgres_condition;
    return {listed(table, table.columns.size()), table.name, condition.empty() ? "TRUE" : condition,
            table.postgres_light};
  }
  postgres::Connection& session() override { return *connection_; }
  std::optional<Failure> naming_store(const Failure& failure) const override {
    if (dynamic_cast<const postgres::PostgresError*>(&failure) == nullptr)
      return std::nullopt;
    return Failure(failure.code(), "store '" + name_ + "': " + failure.what());
  }

  template <typename... Values>
  postgres::Rows run(std::string_view sql, const Values&... values) {
    return named([&] { return connection_->query(sql, values...); });
  }

  void in_one(postgres::Transaction::Kind kind, const std::function<void()>& write) {
    postgres::Transaction transaction(*connection_, kind);
    if (!claim_.empty())
      require_claim();
    write();
    if (const postgres::CommitOutcome outcome = transaction.commit();
        outcome.certainty != postgres::Certainty::Committed)
      throw Failure(ErrorCode::Storage, "store '" + name_ + "': " + outcome.why);
  }

  void require_claim() {
    const postgres::Rows rows = run("SELECT value FROM setting WHERE key = $1 FOR SHARE", kClaim);
    if (rows.empty() || rows.front().column_text(0) != claim_)
      throw Failure(ErrorCode::Unavailable,
                    "store '" + name_ + "': another migrate-store fills it now");
  }

  postgres::Primary primary_;
  const std::string name_;
  std::unique_ptr<postgres::Connection> connection_;
  std::string claim_;
  std::string arrival_;
};

}  // namespace

std::unique_ptr<Side> open_postgres_source(const std::string& url) {
  auto side = std::make_unique<PostgresSide>(url);
  if (!side->has_store())
    throw Failure(ErrorCode::NotFound, "store '" + side->name() + "': there is no store in it");
  side->bring_schema();
  return side;
}

std::unique_ptr<Side> open_postgres_target(const std::string& url) {
  auto side = std::make_unique<PostgresSide>(url);
  side->bring_schema();
  return side;
}

}  // namespace kinship::store::moving
