#include "server/store/postgres/opening/primary.hpp"

#include <utility>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/opening/opening.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::string_view kReadOnly = "25006";

}  // namespace

StandbyState standby_state(Connection& connection, const Uuid& run) {
  const Rows rows = connection.query(
      "SELECT pg_is_in_recovery(), EXISTS (SELECT FROM run WHERE run = $1)", Bytes(run.bytes));
  return {rows.front().column_integer(0) != 0, rows.front().column_integer(1) != 0};
}

Primary::Primary(ConnectionString where, const ConnectionOptions& options)
    : where_(std::move(where)),
      hosts_(where_.each_host()),
      options_{
          .patience = options.patience, .interrupt = options.interrupt, .is_pooled = &is_pooled_} {}

std::unique_ptr<Connection> Primary::connect_to(const ConnectionString& host) const {
  return std::make_unique<Connection>(host, options_);
}

Primary::Found Primary::found(std::unique_ptr<Connection> connection) const {
  require_usable(*connection);
  const std::int64_t timeline = timeline_of(*connection);
  return {std::move(connection), timeline};
}

/// Once more where the first statement showed that there is a pooler (begin_store).
Primary::Found Primary::ask(const ConnectionString& host) const {
  try {
    return found(connect_to(host));
  } catch (const PostgresError& error) {
    if (error.kind() != ErrorKind::Forgotten)
      throw;
    return found(connect_to(host));
  }
}

/// Asks all hosts: one that answers first may be the old primary.
Primary::Found Primary::find_newest() {
  Found newest;
  std::string why;
  bool is_read_only = false;
  for (const ConnectionString& host : hosts_) {
    try {
      Found next = ask(host);
      if (next.timeline <= newest.timeline)
        continue;
      newest = std::move(next);
      const std::lock_guard lock(mutex_);
      newest_ = host;
      newest_until_ = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    } catch (const PostgresError& error) {
      is_read_only = is_read_only || error.kind() == ErrorKind::ReadOnly;
      const std::string what = error.what();
      why += (why.empty() ? "" : "; ") +
             (what.starts_with(host.description()) ? what : host.description() + ": " + what);
    }
  }
  if (!newest.connection)
    throw PostgresError(is_read_only ? kReadOnly : "", why);
  return newest;
}

void Primary::require_newest(const Found& found) {
  const std::lock_guard lock(mutex_);
  if (found.timeline < timeline_)
    throw PostgresError("", description() + ": an old primary came back (timeline " +
                                std::to_string(found.timeline) + ", " + std::to_string(timeline_) +
                                " was met); it has to follow the new "
                                "one (pg_rewind)");
  timeline_ = found.timeline;
}

std::int64_t Primary::timeline() const {
  const std::lock_guard lock(mutex_);
  return timeline_;
}

std::unique_ptr<Connection> Primary::connect() {
  std::optional<ConnectionString> known;
  {
    const std::lock_guard lock(mutex_);
    if (newest_ && (hosts_.size() == 1 || std::chrono::steady_clock::now() < newest_until_))
      known = newest_;
  }
  Found made;
  try {
    if (known)
      made = ask(*known);
  } catch (const PostgresError&) {
    if (hosts_.size() == 1)
      throw;
  }
  if (!made.connection)
    made = find_newest();
  require_newest(made);
  return std::move(made.connection);
}

}  // namespace kinship::store::postgres
