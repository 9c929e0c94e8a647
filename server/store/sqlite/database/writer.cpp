#include "server/store/sqlite/database/writer.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <exception>
#include <optional>

#include "proto/files/file.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/database/wal_file.hpp"
#include "server/store/sqlite/files/named_store.hpp"

namespace kinship::store {
namespace {

const Error kNoMemory{ErrorCode::Unavailable, "no memory"};  // a text too short for any
constexpr const char* kSchema = "PRAGMA user_version";

/// The item's own error, if it had one.
std::optional<Error> apply_alone(WriteItem& item, Batch& batch) {
  Savepoint savepoint(batch.database());
  try {
    item.apply(batch);
  } catch (const SqliteError& error) {
    if (!error.concerns_one_row() || !batch.database().in_transaction())
      throw;
    return error.error();
  } catch (const Failure& failure) {
    return failure.error();
  } catch (const std::bad_alloc&) {
    return kNoMemory;
  } catch (const std::exception& bug) {
    return Error{ErrorCode::Internal, bug.what()};
  }
  savepoint.keep();
  return std::nullopt;
}

/// Whether the rest of the file takes writes: damage, or a trigger, undid this transaction.
bool is_of_batch(const Failure& failure) {
  const auto* const error = dynamic_cast<const SqliteError*>(&failure);
  return error != nullptr && (error->is_damage() || error->concerns_one_row());
}

bool is_busy(const Failure& failure) {
  const auto* const error = dynamic_cast<const SqliteError*>(&failure);
  return error != nullptr && error->is_busy();
}

/// Whether the disk, or the file system, is what failed.
bool is_of_disk(const Failure& failure) {
  if (const auto* const error = dynamic_cast<const SqliteError*>(&failure)) {
    const int code = error->sqlite_code() & 0xff;
    return code == SQLITE_IOERR || code == SQLITE_FULL || code == SQLITE_CANTOPEN;
  }
  return dynamic_cast<const files::FileError*>(&failure) != nullptr;
}

constexpr std::chrono::milliseconds kPauseWithoutMemory{50};

/// For so long a transaction waits for the lock of another program that writes.
void wait_for_lock(Database& database, bool shall_wait) {
  constexpr int kPatience_ms = 500;
  sqlite3_busy_timeout(&database.connection(), shall_wait ? kPatience_ms : 0);
}

}  // namespace

void Batch::raise_generations() {
  for (const auto& [key, retired] : changed_)
    database_
        ->cached(
            "UPDATE experience SET generation = generation + 1,"
            " retired_generation = iif(?, generation + 1, retired_generation) "
            "WHERE task_id = ? AND robot_id = ?")
        ->bind_all(std::int64_t{retired ? 1 : 0}, key.first, key.second)
        .run();
}

Writer::Writer(std::unique_ptr<Database> database, Reopen reopen, const WriterOptions& options)
    : reopen_(std::move(reopen)), options_(options), database_(std::move(database)) {
  watch_wal();
  thread_ = std::thread([this] { run(); });
}

Writer::~Writer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Writer::submit(std::unique_ptr<WriteItem> item) {
  {
    const std::lock_guard lock(mutex_);
    queued_weight_ += item->weight();
    queued_bytes_ += item->bytes();
    queue_.push_back(std::move(item));
  }
  wake_.notify_one();
}

std::size_t Writer::queued() const {
  const std::lock_guard lock(mutex_);
  return queued_weight_;
}

std::size_t Writer::queued_bytes() const {
  const std::lock_guard lock(mutex_);
  return queued_bytes_;
}

std::string Writer::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

WriterFailures Writer::failures() const {
  const std::lock_guard lock(mutex_);
  return failures_;
}

void Writer::run() {
  while (run_once()) {
  }
  close();
}

/// \return false at the end.
bool Writer::run_once() try {
  Items items = take_batch();
  if (!database_ && !reopen_if_due()) {
    const Error error{ErrorCode::Storage, trouble()};
    finish_all(items, &error);
    const std::lock_guard lock(mutex_);
    return !stopping_ || !queue_.empty();
  }
  if (!items.empty()) {
    write(items);
  } else {
    look();
    const std::lock_guard lock(mutex_);
    if (stopping_ && queue_.empty())
      return false;
  }
  checkpoint_if_needed();
  return true;
} catch (const std::bad_alloc&) {  // whoever waits is answered with that, or asks again
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, kPauseWithoutMemory);
  return true;
}

/// Empty if the writer shall stop, or a look or a try is due: after a failure to reopen, or to
/// empty the WAL.
Writer::Items Writer::take_batch() {
  std::unique_lock lock(mutex_);
  const auto something_to_do = [this] { return stopping_ || !queue_.empty(); };
  if (!database_)
    wake_.wait_until(lock, next_try_, something_to_do);
  else if (wal_full())
    wake_.wait_for(lock, std::min(options_.retry_after, options_.look_every), something_to_do);
  else if (options_.look || is_busy_)
    wake_.wait_for(lock, options_.look_every, something_to_do);
  else
    wake_.wait(lock, something_to_do);
  Items items;
  items.reserve(std::min(queue_.size(), options_.batch_cap));  // before any leaves the queue
  std::size_t weight = 0;
  while (!queue_.empty()) {
    const std::size_t next = queue_.front()->weight();
    if (!items.empty() && weight + next > options_.batch_cap)
      break;
    weight += next;
    queued_bytes_ -= queue_.front()->bytes();
    items.push_back(std::move(queue_.front()));
    queue_.pop_front();
  }
  queued_weight_ -= weight;
  return items;
}

void Writer::write(Items& items) {
  std::vector<std::optional<Error>> errors(items.size());
  wait_for_lock(*database_, true);
  try {
    if (items.size() != 1 || !write_whole(*items[0])) {
      Transaction transaction(*database_, Transaction::Kind::Write);
      require_schema();
      Batch batch(*database_);
      for (std::size_t i = 0; i < items.size(); ++i)
        errors[i] = apply_alone(*items[i], batch);
      batch.raise_generations();
      transaction.commit();
    }
    if (options_.look)
      options_.look(*database_, LookAt::Ends);
    if (is_busy_)
      note_busy("");
  } catch (const Failure& failure) {
    if (is_busy(failure)) {
      const Error error{ErrorCode::Storage,
                        "another program writes to the store: " + std::string(failure.what())};
      note_busy(error.message);
      finish_all(items, &error);
      return;
    }
    if (is_of_batch(failure)) {
      write_apart(items);
      return;
    }
    fail(failure);
    const Error error = failure.error();
    finish_all(items, &error);
    reopen_if_due();
    return;
  } catch (const std::bad_alloc&) {  // the transaction is undone
    finish_all(items, &kNoMemory);
    return;
  }
  for (std::size_t i = 0; i < items.size(); ++i)
    finish(*items[i], errors[i] ? &*errors[i] : nullptr);
}

/// An item that finds no memory for its answer has none: who waits for it asks again.
void Writer::finish(WriteItem& item, const Error* error) {
  try {
    item.finish(error);
  } catch (const std::bad_alloc&) {
  }
}

/// Writes one item without savepoints.
/// \return whether it is durable. If not, it did not happen, and is to be written with savepoints,
///         which find the fault.
bool Writer::write_whole(WriteItem& item) {
  Transaction transaction(*database_, Transaction::Kind::Write);
  require_schema();
  Batch batch(*database_, true);
  try {
    item.apply(batch);
  } catch (const SqliteError& error) {
    if (!error.concerns_one_row())
      throw;
    return false;
  } catch (const std::exception&) {
    return false;
  }
  batch.raise_generations();
  transaction.commit();
  return true;
}

/// After damage that undid the batch: each item in a transaction of its own, so that only the one
/// that meets damage fails. An item learns which of its parts that was, and leaves it out in
/// its next try. The rest of the file is fine, nothing is opened again.
void Writer::write_apart(Items& items) {
  for (auto& item : items) {
    std::optional<Error> error;
    if (!database_)
      error = Error{ErrorCode::Storage, trouble()};
    else
      error = write_alone(*item);
    finish(*item, error ? &*error : nullptr);
  }
  if (!database_)
    reopen_if_due();
}

std::optional<Error> Writer::write_alone(WriteItem& item) {
  for (std::size_t tries = item.weight(); true; --tries)
    try {
      Transaction transaction(*database_, Transaction::Kind::Write);
      require_schema();
      Batch batch(*database_);
      std::optional<Error> error = apply_alone(item, batch);
      batch.raise_generations();
      transaction.commit();
      if (options_.look)
        options_.look(*database_, LookAt::Ends);
      return error;
    } catch (const Failure& failure) {
      if (!is_of_batch(failure) && !is_busy(failure))
        fail(failure);
      if (is_busy(failure) || !database_ || tries == 0)
        return failure.error();
    }
}

/// Another program may have migrated the store meanwhile.
void Writer::require_schema() {
  const auto query = database_->cached(kSchema);
  if (!query->step() || query->column_integer(0) != schema_)
    throw Failure(ErrorCode::Storage, "its schema is not the one that it was opened with");
}

void Writer::finish_all(Items& items, const Error* error) {
  for (const auto& item : items)
    finish(*item, error);
}

/// \param trouble  empty: not any more.
void Writer::note_busy(const std::string& trouble) {
  is_busy_ = !trouble.empty();
  const std::lock_guard lock(mutex_);
  trouble_ = trouble;
}

void Writer::fail(const Failure& failure) {
  const bool is_lost = dynamic_cast<const NotTheFile*>(&failure) != nullptr;
  if (database_ && options_.look && !is_lost)
    try {
      options_.look(*database_, LookAt::All);
    } catch (const NotTheFile& cause) {
      return fail(cause);
    } catch (const Failure&) {  // no more than is known
    }
  if (database_)  // nothing more is written by this connection, a checkpoint at its end neither
    sqlite3_db_config(&database_->connection(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  if (database_ && options_.lost && is_lost)
    options_.lost(std::move(database_));
  database_.reset();
  const std::lock_guard lock(mutex_);
  trouble_ = failure.what();
  if (!is_of_disk(failure))
    return;
  failures_.count += 1;
  failures_.last = trouble_;
}

/// While nothing is written.
void Writer::look() {
  if (!database_)
    return;
  try {
    if (options_.look)
      options_.look(*database_, LookAt::Ends);
    if (is_busy_) {
      wait_for_lock(*database_, false);
      const Transaction probe(*database_, Transaction::Kind::Write);
      note_busy("");
    }
  } catch (const Failure& failure) {
    if (is_busy(failure))
      return;
    fail(failure);
    reopen_if_due();
  }
}

/// A try closes all readers and reads the file, so a stream of items must not bring one each.
bool Writer::reopen_if_due() {
  if (std::chrono::steady_clock::now() < next_try_)
    return false;
  try {
    database_ = reopen_();
    watch_wal();
  } catch (const Failure& failure) {
    fail(failure);
  } catch (const std::bad_alloc&) {
    fail(Failure(kNoMemory));
  }
  next_try_ = std::chrono::steady_clock::now() + options_.retry_after;
  if (!database_)
    return false;
  note_busy("");
  return true;
}

/// From now on each commit tells how many pages the WAL has, and each transaction looks whether the
/// schema is still that of now.
void Writer::watch_wal() {
  constexpr std::uint64_t kFrameHeader = 24;
  wal_pages_ = 0;
  wal_bytes_ = 0;
  schema_ = database_->integer(kSchema);
  frame_bytes_ = kFrameHeader + static_cast<std::uint64_t>(database_->integer("PRAGMA page_size"));
  const auto note = [](void* pages, sqlite3*, const char*, int count) {
    *static_cast<std::int64_t*>(pages) = count;
    return SQLITE_OK;
  };
  sqlite3_wal_hook(&database_->connection(), note, &wal_pages_);
}

/// Readers that are younger than the last frame keep it in the WAL, so a checkpoint may leave some.
void Writer::checkpoint_if_needed() {
  if (!database_)
    return;
  try {
    const std::uint64_t bytes = static_cast<std::uint64_t>(wal_pages_) * frame_bytes_;
    const bool full = bytes > options_.max_wal_bytes;
    if (full || bytes >= options_.checkpoint_bytes) {
      if (options_.look)
        options_.look(*database_, LookAt::All);
      wait_for_lock(*database_, false);  // reports would wait as well
      const bool done =
          checkpoint(*database_, full ? CheckpointKind::Whole : CheckpointKind::Passive);
      if (done && full)
        wal_pages_ = 0;
    }
    wal_bytes_ = static_cast<std::uint64_t>(wal_pages_) * frame_bytes_;
  } catch (const Failure& failure) {
    fail(failure);
    reopen_if_due();
  }
}

void Writer::close() {
  if (!database_)
    return;
  try {
    if (options_.look)
      options_.look(*database_, LookAt::All);
    wait_for_lock(*database_, false);
    checkpoint(*database_, CheckpointKind::Whole);
  } catch (const NotTheFile& failure) {
    fail(failure);
  } catch (const Failure&) {
    // All is durable in the WAL already; the next start checkpoints it.
  }
  database_.reset();
}

}  // namespace kinship::store
