#include "server/store/sqlite/opening/history.hpp"

#include <algorithm>
#include <utility>

#include "proto/types/store_epoch.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/files/file_system.hpp"
#include "server/store/tables/settings.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kEpoch = "epoch";
constexpr std::string_view kRuns = "runs";
constexpr std::string_view kKey = "history_key";
constexpr std::string_view kIdentity = "file_identity";
constexpr std::string_view kRelease = "release";

Digest ensure_key(Database& database) {
  if (const std::optional<Digest> key = Digest::from_hex(read_setting(database, kKey)))
    return *key;
  const Digest key = random_key();
  write_setting(database, kKey, key.hex());
  return key;
}

Uuid ensure_epoch(Database& database, const std::filesystem::path& file) {
  const std::string text = read_setting(database, kEpoch);
  if (text.empty())
    return write_new_epoch(database, file);
  const std::optional<Uuid> epoch = Uuid::parse(text);
  if (!epoch)
    throw Failure(ErrorCode::Storage, "its epoch is no UUID");
  return *epoch;
}

void note_release(Database& database) {
  if (read_setting(database, kRelease) != KINSHIP_VERSION)
    write_setting(database, kRelease, KINSHIP_VERSION);
}

}  // namespace

std::string release_of(Database& database) { return read_setting(database, kRelease); }

Uuid write_new_epoch(Database& database, const std::filesystem::path& file, const Uuid& before) {
  const Uuid epoch = next_epoch(Uuid::parse(read_setting(database, kEpoch)).value_or(before));
  write_setting(database, kEpoch, epoch.text());
  write_setting(database, kIdentity, identity_of(file));
  write_setting(database, kRuns, TimelineHistory(epoch).text());
  note_release(database);
  return epoch;
}

std::uint64_t position_of(Database& database) {
  const auto query = database.cached("SELECT max(id) FROM attempt");
  return query->step() ? static_cast<std::uint64_t>(query->column_integer(0)) : 0;
}

History::History(const std::filesystem::path& file) : file_(file), high_water_mark_(file) {}

/// \return why the file cannot be as it was last written; empty: it can.
std::string History::find_rollback(const State& before, const TimelineHistory& log,
                                   std::uint64_t position,
                                   const std::string& stored_identity) const {
  const std::string identity = identity_of(file_);
  if (!may_be_same_file(stored_identity, identity))
    return "the file is a copy (inode and birth " + identity + ", was " + stored_identity + ")";
  const bool is_first_run = before.log.epoch() == Uuid{};
  std::optional<HighWaterMarkFile::Mark> known;
  if (!is_first_run)
    known = {before.log.epoch(), before.log.at(before.position)};
  else
    known = high_water_mark_.read();
  if (!known)
    return "";
  if (known->epoch != log.epoch())
    return "the file is of epoch " + log.epoch().text() + ", was of " + known->epoch.text();
  if (!log.contains(known->point, position))
    return "the file was put back to " + std::to_string(position) + " attempts or fewer, had " +
           std::to_string(known->point.position);
  return "";
}

void History::begin_run(Database& database) {
  State next;
  {
    const std::lock_guard lock(mutex_);
    next = state_;
  }
  Transaction transaction(database, Transaction::Kind::Write);
  const bool is_new = read_setting(database, kEpoch).empty();
  const Uuid epoch = ensure_epoch(database, file_);
  next.key = ensure_key(database);
  std::optional<TimelineHistory> log = TimelineHistory::parse(read_setting(database, kRuns));
  if (!log || log->epoch() != epoch)
    log = TimelineHistory(epoch);
  const std::string stored_identity = read_setting(database, kIdentity);
  const std::uint64_t position = position_of(database);
  const std::string trouble = is_new ? "" : find_rollback(next, *log, position, stored_identity);
  if (!trouble.empty()) {
    log = TimelineHistory(write_new_epoch(database, file_));
    ++next.rollbacks;
    next.trouble = trouble;
  }
  is_run_written_ = log->is_empty();  // the first one is named before it has written anything
  log->begin(Uuid::random(), position);
  if (is_run_written_)
    write_setting(database, kRuns, log->text());
  transaction.commit();
  next.log = std::move(*log);
  next.position = position;
  {
    const std::lock_guard lock(mutex_);
    state_ = std::move(next);
  }
  write_high_water_mark();
}

void History::write_run(Database& database) {
  if (is_run_written_)
    return;
  std::string text;
  {
    const std::lock_guard lock(mutex_);
    text = state_.log.text();
  }
  write_setting(database, kRuns, text);
  note_release(database);
}

void History::committed(std::uint64_t position) {
  is_run_written_ = true;
  {
    const std::lock_guard lock(mutex_);
    if (position <= state_.position)
      return;
    state_.position = position;
  }
  write_high_water_mark();
}

/// On the thread that writes to the store, so that a later mark is never overtaken.
void History::write_high_water_mark() const {
  HighWaterMarkFile::Mark mark;
  {
    const std::lock_guard lock(mutex_);
    mark = {state_.log.epoch(), state_.log.at(state_.position)};
  }
  high_water_mark_.write(mark);
}

Uuid History::epoch() const {
  const std::lock_guard lock(mutex_);
  return state_.log.epoch();
}

std::uint64_t History::position() const {
  const std::lock_guard lock(mutex_);
  return state_.position;
}

StorePoint History::point() const {
  Digest key;
  Uuid epoch;
  LogPosition point;
  {
    const std::lock_guard lock(mutex_);
    key = state_.key;
    epoch = state_.log.epoch();
    point = state_.log.at(state_.position);
  }
  return {epoch, sign(key, epoch, point)};
}

bool History::has_lost(const ConsistencyToken& token) const {
  if (token.empty())
    return false;
  const std::lock_guard lock(mutex_);
  const std::optional<LogPosition> point = verify(state_.key, state_.log.epoch(), token);
  return point && !state_.log.contains(*point, state_.position);
}

std::uint64_t History::rollbacks() const {
  const std::lock_guard lock(mutex_);
  return state_.rollbacks;
}

std::string History::trouble() const {
  const std::lock_guard lock(mutex_);
  return state_.trouble;
}

void History::Renewal::apply(Batch& batch) {
  if (!history_.has_lost(token_))
    return;
  Database& database = batch.database();
  position_ = position_of(database);
  log_.emplace(write_new_epoch(database, history_.file_));
  log_->begin(Uuid::random(), position_);
  write_setting(database, kRuns, log_->text());
}

void History::Renewal::finish(const Error* error) {
  if (error != nullptr) {
    promise_.set_exception(std::make_exception_ptr(Failure(*error)));
    return;
  }
  if (log_) {
    {
      const std::lock_guard lock(history_.mutex_);
      State& state = history_.state_;
      state.trouble = "a client was given a receipt that the store does not have: it was put back";
      ++state.rollbacks;
      state.log = *log_;
      state.position = std::max(state.position, position_);
    }
    history_.is_run_written_ = true;
    history_.write_high_water_mark();
  }
  promise_.set_value(log_.has_value());
}

}  // namespace kinship::store
