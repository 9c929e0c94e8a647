#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// One write transaction while it is being filled.
class Batch {
 public:
  /// \param undone_whole  see is_undone_whole().
  explicit Batch(Database& database, bool undone_whole = false)
      : database_(&database), undone_whole_(undone_whole) {}

  Database& database() const noexcept { return *database_; }

  /// Whether an item may throw instead of undoing a part: then the whole transaction is undone and
  /// written again with savepoints. A savepoint costs a copy of each page changed after it.
  bool is_undone_whole() const noexcept { return undone_whole_; }

  /// Notes that the paths of a robot and task changed; the batch raises their generation once.
  void paths_changed(std::int64_t task_id, std::int64_t robot_id) {
    changed_.try_emplace({task_id, robot_id}, false);
  }
  /// The same; the new generation is also that of the last retirement.
  void paths_retired(std::int64_t task_id, std::int64_t robot_id) {
    changed_[{task_id, robot_id}] = true;
  }
  void raise_generations();

 private:
  Database* database_;
  bool undone_whole_;
  std::map<std::pair<std::int64_t, std::int64_t>, bool> changed_;  // task, robot -> retired
};

/// How much of the files a look reads.
enum class LookAt {
  Ends,  ///< a few bytes, and a share of the WAL
  All    ///< every frame of the WAL
};

/// A write in the queue. apply() and finish() run on the writer's thread.
class WriteItem {
 public:
  virtual ~WriteItem() = default;

  virtual std::size_t weight() const { return 1; }  ///< counts towards the cap of a batch
  virtual std::size_t bytes() const { return 0; }   ///< of memory while it waits

  /// Writes into the batch. An exception undoes this item alone, except an SqliteError that does
  /// not spare the transaction, which undoes the batch. May be called again for another batch.
  virtual void apply(Batch& batch) = 0;

  /// Called once, when the item is durable (no error) or undone, outside of any transaction. Must
  /// not block, nor throw anything but std::bad_alloc.
  virtual void finish(const Error* error) = 0;
};

struct WriterOptions {
  std::size_t batch_cap = 256;  ///< weight of one transaction, unless one item exceeds it alone
  std::chrono::milliseconds retry_after{1000};  ///< between two tries to reopen a failed database
  std::uint64_t checkpoint_bytes = std::uint64_t{32} << 20U;  ///< of the WAL, to checkpoint it
  std::uint64_t max_wal_bytes = std::uint64_t{512} << 20U;    ///< see Writer::wal_full()
  /// Throws Failure if the connection's files are not those of the store any more. Called after
  /// each commit, before its items are finished, and so often meanwhile, and looks at all before a
  /// checkpoint, and after another failure, to find its cause; may be empty.
  std::function<void(Database&, LookAt)> look = {};
  std::chrono::milliseconds look_every{250};
  /// Takes the connection, when the look threw NotTheFile, to save what it has once the items are
  /// finished; it is closed otherwise.
  std::function<void(std::unique_ptr<Database>)> lost = {};
};

/// I/O errors, full disks, and files that could not be opened, so far.
struct WriterFailures {
  std::uint64_t count = 0;
  std::string last;  ///< message of the last one
};

/// The thread that owns the only writing connection. It writes all queued items in one transaction,
/// up to the cap, and finishes them after the commit is durable, without a timer. When the WAL is
/// long enough it checkpoints after that, so that no item waits for it.
///
/// If a batch meets damage, or a trigger that undoes it, its items are written one by one, and only
/// the items that need the damaged data fail. Once another program has migrated the store nothing
/// is written any more.
///
/// While another program writes, items are answered with an error that says so, and the connection
/// stays.
///
/// Fail-stop: on an I/O error or a full disk, in a checkpoint too, it undoes the batch, finishes
/// every item with the error, closes the connection and opens it again with checks, but never
/// sooner than `retry_after` after the last try; until a try succeeds items are answered with the
/// error.
class Writer {
 public:
  /// \param database  the connection to begin with.
  /// \param reopen    makes a checked connection after a failure, or throws Failure. Called on the
  ///                  writer's thread when the old connection is closed.
  using Reopen = std::function<std::unique_ptr<Database>()>;
  Writer(std::unique_ptr<Database> database, Reopen reopen, const WriterOptions& options = {});
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  /// Writes the queued items, checkpoints, and closes the connection.
  ~Writer();

  void submit(std::unique_ptr<WriteItem> item);

  std::size_t queued() const;        ///< weight of the waiting items
  std::size_t queued_bytes() const;  ///< their size
  /// Empty while items are written; else the reason why not.
  std::string trouble() const;
  WriterFailures failures() const;  ///< since the writer began

  std::uint64_t wal_bytes() const noexcept { return wal_bytes_; }  ///< in use, not of the file
  /// Whether the WAL exceeds its limit, because readings pin it. Items are still written. The
  /// writer tries every `retry_after` to empty it.
  bool wal_full() const noexcept { return wal_bytes_ > options_.max_wal_bytes; }

 private:
  using Items = std::vector<std::unique_ptr<WriteItem>>;

  void run();
  bool run_once();
  Items take_batch();
  void write(Items& items);
  bool write_whole(WriteItem& item);
  void write_apart(Items& items);
  std::optional<Error> write_alone(WriteItem& item);
  static void finish(WriteItem& item, const Error* error);
  void require_schema();
  void finish_all(Items& items, const Error* error);
  void fail(const Failure& failure);
  void note_busy(const std::string& trouble);
  bool reopen_if_due();
  void watch_wal();
  void checkpoint_if_needed();
  void look();
  void close();

  const Reopen reopen_;
  const WriterOptions options_;
  // The writer's thread only:
  std::unique_ptr<Database> database_;                // empty after a failure
  std::int64_t wal_pages_ = 0;                        // as of the last commit
  bool is_busy_ = false;                              // another program writes
  std::uint64_t frame_bytes_ = 0;                     // of one of these pages
  std::int64_t schema_ = 0;                           // version, when it was opened
  std::chrono::steady_clock::time_point next_try_{};  // to reopen; long past at first

  std::atomic<std::uint64_t> wal_bytes_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::unique_ptr<WriteItem>> queue_;  // guarded by mutex_, like all below
  std::size_t queued_weight_ = 0;
  std::size_t queued_bytes_ = 0;
  std::string trouble_;
  WriterFailures failures_;
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace kinship::store
