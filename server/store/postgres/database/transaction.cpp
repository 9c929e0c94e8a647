#include "server/store/postgres/database/transaction.hpp"

#include <array>
#include <exception>
#include <vector>

#include "server/store/postgres/database/postgres_error.hpp"

namespace kinship::store::postgres {
namespace {

/// Set with the transaction, not with the connection: a pooler may give each another session. To
/// plan a batch's statements anew takes a third of its time, and no plan is better for its values.
constexpr std::string_view kWriteSettings =
    "SELECT set_config('statement_timeout', '0', true), set_config('lock_timeout', '8s', true),"
    " set_config('plan_cache_mode', 'force_generic_plan', true),"
    " set_config('synchronous_commit', CASE current_setting('synchronous_commit')"
    " WHEN 'remote_apply' THEN 'remote_apply' ELSE 'on' END, true),"
    " (SELECT coalesce(max(version), 0) FROM schema_migration)";
constexpr int kSchemaOfSettings = 4;  // column of it; its table stays locked against migrations

constexpr std::string_view kLocalSettings =
    "SELECT set_config('statement_timeout', '0', true), set_config('lock_timeout', '8s', true),"
    " set_config('synchronous_commit', 'local', true)";

/// Whether an error of a COMMIT says that the transaction was undone.
bool is_undone(const PostgresError& error) {
  return error.kind() == ErrorKind::Conflict || error.kind() == ErrorKind::OneRow;
}

}  // namespace

Transaction::Transaction(Connection& connection, Kind kind) : connection_(&connection) {
  if (kind == Kind::Snapshot) {
    connection.query("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
    return;
  }
  const std::array<Request, 2> begin = {
      Request{"BEGIN ISOLATION LEVEL READ COMMITTED READ WRITE"},
      Request{kind == Kind::Write ? kWriteSettings : kLocalSettings}};
  const std::vector<Rows> begun = connection.query_all(begin);
  if (kind == Kind::Write)
    schema_ = begun.back().front().column_integer(kSchemaOfSettings);
}

Transaction::~Transaction() {
  if (!is_open_ || !connection_->is_alive())
    return;
  try {
    connection_->query("ROLLBACK");
  } catch (const std::exception&) {
    connection_->abandon();
  }
}

CommitOutcome Transaction::commit() noexcept {
  is_open_ = false;
  try {
    static_cast<void>(connection_->take_warning());
    const Rows done = connection_->query_without_limit("COMMIT");
    if (done.command_tag() != "COMMIT")
      return {Certainty::NotCommitted, "the transaction had failed and was rolled back"};
    if (std::string warning = connection_->take_warning(); !warning.empty())
      return {Certainty::InDoubt, std::move(warning)};
    return {Certainty::Committed, ""};
  } catch (const PostgresError& error) {
    return {is_undone(error) ? Certainty::NotCommitted : Certainty::InDoubt, error.what(),
            error.sqlstate()};
  } catch (const std::exception& error) {
    connection_->abandon();
    return {Certainty::InDoubt, error.what()};
  }
}

Savepoint::Savepoint(Connection& connection) : connection_(&connection) {
  connection.query("SAVEPOINT one");
}

Savepoint::~Savepoint() {
  if (!is_open_ || !connection_->is_alive())
    return;
  try {
    connection_->query("ROLLBACK TO SAVEPOINT one");
  } catch (const std::exception&) {
    connection_->abandon();
  }
}

void Savepoint::keep() {
  is_open_ = false;
  connection_->query("RELEASE SAVEPOINT one");
}

}  // namespace kinship::store::postgres
