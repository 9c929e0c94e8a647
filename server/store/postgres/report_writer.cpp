#include "server/store/postgres/report_writer.hpp"

#include <utility>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/database/transaction.hpp"
#include "server/store/postgres/opening/migrations.hpp"
#include "server/store/postgres/rows/batch.hpp"
#include "server/store/postgres/rows/retirement.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::chrono::milliseconds kPauseWithoutMemory{50};
constexpr int kTries = 5;  // of a transaction that is in conflict with another server's

std::string in_doubt(const std::string& why) {
  return "whether it is stored is not certain (" + why + "); a report that comes again tells";
}

/// Retires the reports that another store retired, before they are looked at. \return whether there
/// are any.
bool retire_first(Connection& connection, const std::vector<const PreparedAttempt*>& attempts) {
  std::vector<Uuid> retired;
  for (const PreparedAttempt* const prepared : attempts)
    if (prepared->is_retired)
      retired.push_back(prepared->attempt.report_uuid);
  if (!retired.empty())
    retire_reports(connection, retired);
  return !retired.empty();
}

}  // namespace

void require_standby(Connection& connection) {
  const Rows rows = connection.query(
      "SELECT current_setting('synchronous_standby_names'), current_setting('synchronous_commit')");
  const std::string_view names = rows.front().column_text(0), level = rows.front().column_text(1);
  if (names.empty())
    throw PostgresError("55000",
                        "--require-synchronous: the database has no synchronous standby "
                        "(synchronous_standby_names is empty)");
  if (level != "on" && level != "remote_apply")
    throw PostgresError("55000", "--require-synchronous: synchronous_commit is '" +
                                     std::string(level) + "' and cannot be set to 'on'");
}

ReportWriter::ReportWriter(Primary& primary, History& history,
                           std::unique_ptr<Connection> connection, ReportWriterOptions options,
                           std::function<void(Connection&)> connected)
    : primary_(primary),
      history_(history),
      options_(std::move(options)),
      put_off_(options_.put_off_for),
      connected_(std::move(connected)),
      connection_(std::move(connection)),
      thread_([this] { run(); }) {}

ReportWriter::~ReportWriter() {
  constexpr std::chrono::seconds kPatience{5};
  queue_.close();
  {
    std::unique_lock lock(mutex_);
    if (!ended_.wait_for(lock, kPatience, [this] { return has_ended_; }) && interrupt_ != nullptr)
      interrupt_->raise();
  }
  thread_.join();
}

std::string ReportWriter::trouble() const {
  constexpr std::int64_t kUsualWait_ms = 2000;
  const std::int64_t since = waits_since_ms_;
  if (const std::int64_t waited = since == 0 ? 0 : now_ms() - since; waited > kUsualWait_ms)
    return "a commit has been waiting for a standby, or for the disk, for " +
           std::to_string(waited / 1000) + " s";
  const std::lock_guard lock(mutex_);
  return trouble_;
}

void ReportWriter::run() {
  for (bool goes_on = true; goes_on;)
    try {
      goes_on = run_once();
    } catch (const std::bad_alloc&) {  // who waits for the items has no answer, and asks again
      std::this_thread::sleep_for(kPauseWithoutMemory);
    }
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  ended_.notify_all();
}

/// \return false at the end.
bool ReportWriter::run_once() {
  std::optional<std::vector<QueuedItem>> items = queue_.take();
  if (!items)
    return false;
  const bool connected = is_connected();
  if (items->empty() && connected)
    look_around();
  if (connected)
    write(*items);
  for (QueuedItem& item : *items) {
    if (!connected)
      for (std::size_t i = 0; i < item.receipts.size(); ++i)
        if (item.prepared[i])
          item.receipts[i] = {item.receipts[i].report_uuid, ReceiptStatus::TryAgain, trouble()};
    if (item.done)
      item.done(item.receipts);
  }
  return true;
}

void ReportWriter::write(std::vector<QueuedItem>& items) {
  std::vector<Pending> pending;
  for (QueuedItem& item : items)
    for (std::size_t i = 0; i < item.prepared.size(); ++i)
      if (item.prepared[i])
        pending.push_back({&*item.prepared[i], &item.receipts[i]});
  if (!pending.empty())
    write_reports(pending);
  for (const QueuedItem& item : items)
    if (item.write)
      write_alone(item.write);
}

/// An attempt that the database does not take is found by halves, and put off alone.
void ReportWriter::write_reports(std::span<Pending> pending) {
  if (!connection_)
    return answer(pending, trouble());
  if (try_reports(pending))
    return;
  const std::size_t half = pending.size() / 2;
  write_reports(pending.first(half));
  write_reports(pending.subspan(half));
}

/// \return false if the database does not take one of several.
bool ReportWriter::try_reports(std::span<Pending> pending) {
  std::vector<const PreparedAttempt*> attempts;
  for (const Pending& each : pending)
    attempts.push_back(each.prepared);
  for (int tries = 1;; ++tries) {
    try {
      Transaction transaction(*connection_, Transaction::Kind::Write);
      require_schema(transaction.schema());
      if (options_.require_synchronous)
        require_standby(*connection_);
      const std::int64_t now = now_ms();
      const bool has_retired = retire_first(*connection_, attempts);
      const std::uint64_t max_paths = options_.max_paths_per_pair;
      const BatchChanges changes =
          resolve_reports(attempts, read_state(*connection_, attempts, max_paths), max_paths, now);
      if (has_retired || !changes.is_empty()) {
        const History::Step step = history_.advance(*connection_);
        write_changes(*connection_, changes, now);
        waits_since_ms_ = now_ms();
        const CommitOutcome outcome = transaction.commit();
        waits_since_ms_ = 0;
        if (outcome.certainty == Certainty::NotCommitted)
          throw PostgresError(outcome.sqlstate, outcome.why);
        if (outcome.certainty == Certainty::InDoubt) {
          give_up(outcome.why);
          answer(pending, in_doubt(outcome.why));
          return true;
        }
        history_.committed(step);
      }
      for (std::size_t i = 0; i < pending.size(); ++i)
        *pending[i].receipt = changes.receipts[i];
      note("");
      return true;
    } catch (const PostgresError& error) {
      if (error.kind() == ErrorKind::Conflict && tries < kTries)
        continue;
      if (error.kind() == ErrorKind::OneRow) {
        if (pending.size() > 1)
          return false;
        put_off_.note(pending.front().prepared->attempt.report_uuid, error.what());
        answer(pending, error.what());
        return true;
      }
      if (error.kind() == ErrorKind::Forgotten && tries < kTries) {
        give_up(error.what());
        next_try_ = {};
        if (is_connected())
          continue;
      }
      if (error.kind() == ErrorKind::Lost || error.kind() == ErrorKind::ReadOnly ||
          (connection_ && !connection_->is_alive()))
        give_up(error.what());
      else
        note(error.what());
      answer(pending, error.what());
      return true;
    }
  }
}

void ReportWriter::write_alone(const std::function<void(Connection&)>& write) {
  if (!connection_)
    return;  // a write without a waiter may be lost
  try {
    Transaction transaction(*connection_, Transaction::Kind::Write);
    require_schema(transaction.schema());
    write(*connection_);
    if (const CommitOutcome outcome = transaction.commit(); outcome.certainty == Certainty::InDoubt)
      give_up(outcome.why);
  } catch (const PostgresError& error) {
    if (error.kind() == ErrorKind::Lost)
      give_up(error.what());
  }
}

void ReportWriter::answer(std::span<Pending> pending, const std::string& why) {
  for (const Pending& each : pending)
    *each.receipt = {each.prepared->attempt.report_uuid, ReceiptStatus::TryAgain, why};
}

bool ReportWriter::is_connected() {
  if (connection_ && connection_->is_alive())
    return true;
  connection_.reset();
  if (std::chrono::steady_clock::now() < next_try_)
    return false;
  try {
    std::unique_ptr<Connection> connection = primary_.connect();
    migrate(*connection, embedded_migrations());
    history_.begin_run(*connection);
    connection_ = std::move(connection);
    connected_(*connection_);
    note("");
    return true;
  } catch (const Failure& failure) {
    give_up(failure.what());
    return false;
  }
}

/// Once a second while nothing is to be written.
void ReportWriter::look_around() {
  try {
    if (connection_->query("SELECT pg_is_in_recovery()").front().column_integer(0) != 0)
      return give_up("the database has become a standby");
    require_schema(schema_of(*connection_));
    history_.refresh(*connection_);
    if (options_.require_synchronous)
      require_standby(*connection_);
    note("");
  } catch (const PostgresError& error) {
    if (connection_->is_alive())
      note(error.what());
    else
      give_up(error.what());
  }
}

void ReportWriter::give_up(const std::string& why) {
  connection_.reset();
  next_try_ = std::chrono::steady_clock::now() + options_.retry_after;
  note(why);
}

void ReportWriter::note(const std::string& why) {
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    is_new = trouble_.empty() != why.empty();
    trouble_ = why;
  }
  if (is_new && options_.log)
    options_.log(why.empty() ? "reports are stored again" : "reports are not stored: " + why);
}

}  // namespace kinship::store::postgres
