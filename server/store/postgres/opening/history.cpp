#include "server/store/postgres/opening/history.hpp"

#include <array>
#include <utility>

#include "proto/types/store_epoch.hpp"
#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/transaction.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/tables/settings.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/consistency_token.hpp"
#include "server/store/values/move_marks.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::string_view kKey = "history_key";
constexpr std::string_view kIdentity = "database_identity";
constexpr std::string_view kForgottenRun = "forgotten_run";
constexpr std::string_view kTimeline = "timeline";
constexpr std::int64_t kMoreThanWereLost = 1'000'000;

/// A key that another server wrote before counts.
Digest ensure_key(Connection& connection) {
  if (const std::optional<Digest> key = Digest::from_hex(read_setting(connection, kKey)))
    return *key;
  const Digest key = random_key();
  write_setting(connection, kKey, key.hex());
  return key;
}

struct NewestEpoch {
  std::int64_t number = 0;  // 0: there is none
  Uuid epoch;
};

constexpr std::string_view kNewestEpoch =
    "SELECT number, epoch FROM epoch ORDER BY number DESC LIMIT 1";

NewestEpoch read_epoch(const Rows& rows) {
  if (rows.empty())
    return {};
  return {rows.front().column_integer(0), id_of<Uuid>(rows.front().column_blob(1))};
}

NewestEpoch newest_epoch(Connection& connection) {
  return read_epoch(connection.query(kNewestEpoch));
}

/// Paths and scenes that were lost had ids which servers have in memory: no other ones get these.
void skip_lost_ids(Connection& connection) {
  for (const char* const table : {"path", "scene"})
    connection.query(
        "SELECT setval(pg_get_serial_sequence($1, 'id'),"
        " nextval(pg_get_serial_sequence($1, 'id')) + $2)",
        table, kMoreThanWereLost);
}

/// With the lock of lock_epochs().
Uuid begin_epoch(Connection& connection, std::string_view reason) {
  NewestEpoch before = newest_epoch(connection);
  if (before.number == 0)
    before.epoch = Uuid::parse(read_setting(connection, kMovedFrom)).value_or(Uuid{});
  const Uuid epoch = next_epoch(before.epoch);
  connection.query("INSERT INTO epoch VALUES ($1, $2, $3, $4)", before.number + 1,
                   Bytes(epoch.bytes), now_ms(), reason);
  if (before.number > 0) {
    // The generations of lost paths come again now, with other paths.
    connection.query("SELECT 1 FROM experience ORDER BY task_id, robot_id FOR NO KEY UPDATE");
    connection.query(
        "UPDATE experience SET changed_in = pg_current_xact_id(),"
        " generation = generation + $1 WHERE generation > 0",
        kMoreThanWereLost);
    skip_lost_ids(connection);
  }
  return epoch;
}

void lock_epochs(Connection& connection) {
  connection.query("LOCK TABLE epoch IN SHARE ROW EXCLUSIVE MODE");
}

std::optional<std::uint64_t> position_of(Connection& connection, const Uuid& run) {
  const Rows rows = connection.query("SELECT position FROM run WHERE run = $1", Bytes(run.bytes));
  return rows.empty() ? std::nullopt : std::optional(count_of(rows.front(), 0));
}

/// A UUID that begins with the time, so that runs order by it (RFC 9562, version 7).
Uuid timed_uuid() {
  Uuid uuid = Uuid::random();
  auto time = static_cast<std::uint64_t>(now_ms());
  constexpr std::size_t kTimeBytes = 6;
  for (std::size_t i = kTimeBytes; i-- > 0; time >>= 8U)
    uuid.bytes[i] = static_cast<std::uint8_t>(time);
  constexpr std::size_t kVersion = 6;
  uuid.bytes[kVersion] = static_cast<std::uint8_t>(0x70U | (uuid.bytes[kVersion] & 0x0FU));
  return uuid;
}

/// Runs beyond the newest few thousand go; the last of them is remembered: a token of one that old
/// is not taken for lost.
void forget_old_runs(Connection& connection) {
  constexpr std::int64_t kKeptRuns = 4096;
  const Rows rows = connection.query(
      "WITH gone AS (DELETE FROM run WHERE run <= (SELECT run FROM run ORDER BY run DESC"
      " OFFSET $1 LIMIT 1) RETURNING run) SELECT run FROM gone ORDER BY run DESC LIMIT 1",
      kKeptRuns);
  if (!rows.empty())
    write_setting(connection, kForgottenRun, id_of<Uuid>(rows.front().column_blob(0)).text());
}

}  // namespace

std::string identity_of(Connection& connection) {
  const Rows rows = connection.query(
      "SELECT system_identifier::text || '/' ||"
      " (SELECT oid::text FROM pg_database WHERE datname = current_database())"
      " FROM pg_control_system()");
  return std::string(rows.front().column_text(0));
}

/// \return why earlier commits cannot be there; empty: they are, or another server began an epoch
///         because of the loss.
std::string History::find_loss(Connection& connection, const State& before,
                               const Uuid& newest) const {
  const std::string stored = read_setting(connection, kIdentity);
  if (const std::string identity = identity_of(connection); !stored.empty() && stored != identity)
    return "the database is a copy (cluster and database " + identity + ", was " + stored + ")";
  if (before.epoch == Uuid{})
    return "";
  const bool knows_epoch =
      !connection.query("SELECT 1 FROM epoch WHERE epoch = $1", Bytes(before.epoch.bytes)).empty();
  if (!knows_epoch)
    return "the database does not know epoch " + before.epoch.text() + " any more";
  if (newest != before.epoch)
    return "";
  const std::uint64_t position = position_of(connection, before.run).value_or(0);
  if (position < before.position)
    return "the last " + std::to_string(before.position - position) +
           " commits of this server are gone: another server was promoted without them, or the "
           "database was put back";
  return "";
}

void History::begin_run(Connection& connection) {
  State next;
  {
    const std::lock_guard lock(mutex_);
    next = state_;
  }
  // Waits for no standby: a run that begins has given no receipt yet, and gives them once later
  // commits are replicated.
  Transaction transaction(connection, Transaction::Kind::Local);
  lock_epochs(connection);
  const NewestEpoch newest = newest_epoch(connection);
  const std::string loss = newest.number == 0 ? "" : find_loss(connection, next, newest.epoch);
  if (newest.number == 0)
    next.epoch = begin_epoch(connection, "the store was made");
  else
    next.epoch = loss.empty() ? newest.epoch : begin_epoch(connection, loss);
  write_setting(connection, kIdentity, identity_of(connection));
  const std::string timeline = std::to_string(timeline_of(connection));
  // Commits that a standby lacked when it was promoted may be of servers that cannot be asked.
  if (const std::string before = read_setting(connection, kTimeline);
      !before.empty() && before != timeline)
    skip_lost_ids(connection);
  write_setting(connection, kTimeline, timeline);
  next.key = ensure_key(connection);
  next.run = timed_uuid();
  next.position = 1;  // vouches for all that was there before
  connection.query("INSERT INTO run VALUES ($1, 1)", Bytes(next.run.bytes));
  forget_old_runs(connection);
  if (const CommitOutcome outcome = transaction.commit(); outcome.certainty != Certainty::Committed)
    throw PostgresError("", "no run could be begun: " + outcome.why);
  if (!loss.empty()) {
    ++next.rollbacks;
    next.trouble = loss;
  }
  const std::lock_guard lock(mutex_);
  state_ = std::move(next);
  seen_runs_.clear();
}

History::Step History::advance(Connection& connection) const {
  Uuid run;
  Step step;
  {
    const std::lock_guard lock(mutex_);
    run = state_.run;
    step.position = state_.position + 1;
  }
  const std::array<Request, 2> requests = {
      Request{kNewestEpoch},
      Request{"INSERT INTO run VALUES ($1, $2)"
              " ON CONFLICT (run) DO UPDATE SET position = excluded.position",
              Parameters(Bytes(run.bytes), static_cast<std::int64_t>(step.position))}};
  step.epoch = read_epoch(connection.query_all(requests).front()).epoch;
  return step;
}

void History::committed(const Step& step) {
  const std::lock_guard lock(mutex_);
  state_.epoch = step.epoch;
  state_.position = step.position;
}

void History::refresh(Connection& connection) {
  const Uuid newest = newest_epoch(connection).epoch;
  const std::lock_guard lock(mutex_);
  state_.epoch = newest;
}

Uuid History::epoch() const {
  const std::lock_guard lock(mutex_);
  return state_.epoch;
}

Uuid History::run() const {
  const std::lock_guard lock(mutex_);
  return state_.run;
}

StorePoint History::point() const {
  Digest key;
  Uuid epoch;
  LogPosition point;
  {
    const std::lock_guard lock(mutex_);
    key = state_.key;
    epoch = state_.epoch;
    point = {state_.run, state_.position};
  }
  return {epoch, sign(key, epoch, point)};
}

std::optional<LogPosition> History::find_unconfirmed(const ConsistencyToken& token) const {
  if (token.empty())
    return std::nullopt;
  const std::lock_guard lock(mutex_);
  const std::optional<LogPosition> point = verify(state_.key, state_.epoch, token);
  if (!point || (point->run == state_.run && point->position <= state_.position))
    return std::nullopt;
  const auto seen = seen_runs_.find(point->run);
  if (seen != seen_runs_.end() && point->position <= seen->second)
    return std::nullopt;
  return point;
}

bool History::is_gone(Connection& connection, const LogPosition& point) const {
  const std::optional<std::uint64_t> position = position_of(connection, point.run);
  if (!position) {
    const std::optional<Uuid> forgotten = Uuid::parse(read_setting(connection, kForgottenRun));
    return !forgotten || *forgotten < point.run;
  }
  constexpr std::size_t kMostSeen = 65'536;
  const std::lock_guard lock(mutex_);
  if (seen_runs_.size() >= kMostSeen)
    seen_runs_.clear();
  seen_runs_[point.run] = *position;
  return *position < point.position;
}

std::optional<History::Begun> History::begin_epoch_if_lost(Connection& connection,
                                                           const ConsistencyToken& token) const {
  lock_epochs(connection);
  Digest key;
  {
    const std::lock_guard lock(mutex_);
    key = state_.key;
  }
  const std::optional<LogPosition> point = verify(key, newest_epoch(connection).epoch, token);
  if (!point || !is_gone(connection, *point))
    return std::nullopt;
  const std::string why =
      "a client was given a receipt that the store does not have: it was put back";
  return Begun{begin_epoch(connection, why), why};
}

void History::adopt(const Begun& begun) {
  const std::lock_guard lock(mutex_);
  state_.epoch = begun.epoch;
  ++state_.rollbacks;
  state_.trouble = begun.why;
}

std::uint64_t History::rollbacks() const {
  const std::lock_guard lock(mutex_);
  return state_.rollbacks;
}

std::string History::trouble() const {
  const std::lock_guard lock(mutex_);
  return state_.trouble;
}

}  // namespace kinship::store::postgres
