#include "server/store/sqlite/sqlite_store.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "server/store/sql_store.hpp"
#include "server/store/sqlite/database/call_item.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/disk_budget.hpp"
#include "server/store/sqlite/files/disk_space.hpp"
#include "server/store/sqlite/files/leftovers.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"
#include "server/store/sqlite/report_item.hpp"
#include "server/store/sqlite/rows/damage_search.hpp"
#include "server/store/sqlite/rows/export_rows.hpp"
#include "server/store/sqlite/rows/listings.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/sqlite/upkeep/file_watch.hpp"
#include "server/store/sqlite/upkeep/scrub.hpp"
#include "server/store/sqlite/upkeep/store_backup.hpp"
#include "server/store/tables/distributions.hpp"

namespace kinship::store {
namespace {

/// The lock of a store that exists from now on.
StoreLock lock_for_serving(const std::filesystem::path& file, bool is_new) {
  const auto make = [&] {
    if (std::filesystem::exists(file))
      return;
    make_for_owner(file);
    files::sync_folder_of(file);  // a lock that outlives the file says that the file is gone
  };
  if (is_new)
    return StoreLock(file, [&] {
      set_leftovers_aside(file);
      make();
    });
  require_no_leftovers(file);
  make();  // before the lock: without a file that would be no new store after a crash
  return StoreLock(file);
}

class SqliteStore : public SqlStore {
 public:
  SqliteStore(const std::filesystem::path& file, const SqliteOptions& options)
      : SqlStore(options.max_distribution_bytes, options.searches),
        options_(options),
        file_(locate_servable(file)),
        lock_(lock_for_serving(file_, options.new_store)),
        history_(file_),
        readers_(file_),
        watch_(file_, lock_, readers_, history_, options.log),
        space_(file_, options.free_space_watermark_bytes, options.ballast_bytes) {
    std::unique_ptr<Database> database = open_writer(file_);
    history_.begin_run(*database);
    watch_.note_opened(*database);
    for (const std::string& line : mend_indexes(*database))
      if (options.log)
        options.log(line);
    writer_ = std::make_unique<Writer>(
        std::move(database), [this] { return reopen(); },
        WriterOptions{
            .retry_after = options.retry_after,
            .checkpoint_bytes = options.checkpoint_bytes,
            .max_wal_bytes = options.max_wal_bytes,
            .look = [this](Database& writing, LookAt what) { watch_.require_named(writing, what); },
            .lost = [this](std::unique_ptr<Database> lost) { watch_.keep(std::move(lost)); }});
    scrub_ = std::make_unique<Scrub>(readers_, *writer_,
                                     ScrubOptions{options.scrub_bytes_per_s, options.log});
  }
  // Readers close before the writer does, whose last act is to empty the WAL.
  ~SqliteStore() override {
    scrub_.reset();
    readers_.suspend();
  }

  Uuid epoch() const override { return history_.epoch(); }
  StorePoint point() const override { return history_.point(); }
  bool has_lost(const ConsistencyToken& token) const override { return history_.has_lost(token); }

  bool begin_epoch_if_lost(const ConsistencyToken& token) override {
    return answer_to(*writer_, std::make_unique<History::Renewal>(history_, token));
  }

  StoreStatus status() const override {
    StoreStatus status = counted();
    const std::string uncounted = std::exchange(status.message, {});
    status.file = file_.string();
    status.epoch = history_.epoch();
    status.rollbacks = history_.rollbacks();
    status.queued = writer_->queued();
    status.wal_bytes = writer_->wal_bytes();
    status.max_paths_per_pair = options_.max_paths_per_pair;
    status.max_distribution_bytes = options_.max_distribution_bytes;
    status.max_search_bytes = options_.searches.bytes;
    describe_disk(status, space_, *writer_, out_of_space_reason());
    if (status.rollbacks > 0)
      status.message +=
          "rolled back, clients offer again what is missing: " + history_.trouble() + "; ";
    status.message += uncounted;
    if (!watch_.trouble().empty())
      status.message += "what is counted was so before; ";
    if (const std::string told = put_off_.told(); !told.empty())
      status.message += told + "; ";
    describe_damage(status, damaged_robots(), scrub_->findings());
    status.scrubbed_ms = scrub_->progress().ended_ms;
    status.scrub_part = scrub_->progress().part;
    if (!status.message.empty())
      status.message.resize(status.message.size() - 2);
    return status;
  }

  void commit_reports(std::vector<Attempt> attempts, ReportsDone done) override {
    commit(std::move(attempts), std::move(done));
  }

  Feed<ArrivedReport> list_arrivals(std::string_view task, std::string_view cursor,
                                    std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_arrivals(*reader, task, cursor, limit);
  }

  Feed<Uuid> list_retirements(std::string_view cursor, std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_retirements(*reader, cursor, limit);
  }

  std::map<Uuid, Digest> known_reports(std::span<const Uuid> reports) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return select_known(*reader, reports);
  }

  ReplicatedReports read_reports(std::span<const Uuid> reports,
                                 std::size_t max_bytes) const override {
    const ReaderPool::Lease reader = readers_.lease();
    ReplicatedRead read = select_replicated(*reader, reports, max_bytes);
    quarantine_later(std::move(read.damaged));
    return std::move(read.found);
  }

  void commit_replicated(std::vector<ReplicatedReport> reports, ReportsDone done) override {
    commit(std::move(reports), std::move(done));
  }

  std::optional<std::string> why_put_off(const Uuid& report) const override {
    return put_off_.find(report);
  }

  std::vector<Retirement> retire_reports(std::span<const Uuid> reports) override {
    return write([&](Batch& batch) { return store::retire_reports(batch, reports); });
  }

  std::vector<StoredPath> read_paths(const Digest& robot, std::string_view task,
                                     const PathRange& range) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return undamaged(select_paths(*reader, robot, task, range));
  }

  std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                     std::uint64_t /*generation*/) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return select_path_ids(*reader, robot, task);
  }

  std::optional<RecordedScene> read_scene(std::int64_t scene_id) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return undamaged(select_current_scene(*reader, scene_id), scene_id);
  }

  Result<Retirement> retire_path(const Uuid& report_uuid, const AuditEntry* audit) override {
    return write([&](Batch& batch) { return store::retire_path(batch, report_uuid, audit); });
  }

  void note_use(const Digest& id) const override {
    run_writing_later([id](Session& session, const RetireSome&) { store::note_use(session, id); });
  }

  Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                               std::string_view cursor, std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_paths(*reader, {robot, task}, cursor, limit);
  }

  Page<AttemptSummary> list_attempts(const std::optional<Digest>& robot, std::string_view task,
                                     std::string_view cursor, std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_attempts(*reader, {robot, task}, cursor, limit);
  }

  std::optional<Attempt> find_attempt(const Uuid& report_uuid) const override {
    const ReaderPool::Lease reader = readers_.lease();
    DamagedRows damaged;
    Result<Attempt> attempt = store::find_attempt(*reader, report_uuid, damaged);
    quarantine_later(std::move(damaged));
    if (attempt)
      return std::move(attempt).value();
    if (attempt.error().code == ErrorCode::NotFound)
      return std::nullopt;
    throw Failure(attempt.error());
  }

  Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                std::string_view cursor, std::size_t limit,
                                std::size_t max_bytes) const override {
    const ReaderPool::Lease reader = readers_.lease();
    ExportRead read = export_page(*reader, {robot, task}, cursor, limit, max_bytes);
    quarantine_later(std::move(read.damaged));
    return std::move(read.page);
  }

  Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                               std::string_view task, std::string_view cursor,
                                               std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_distributions(*reader, {robot, task}, cursor, limit);
  }

  Result<bool> backup(const std::filesystem::path& file,
                      const std::function<bool(double)>& progress) const override {
    return back_up(*writer_, file, progress);
  }

 private:
  void run_reading(View /*view*/, const Reading& reading) const override {
    const ReaderPool::Lease reader = readers_.lease();
    reading(*reader);
  }
  void run_writing(const Writing& writing) override {
    write([&](Batch& batch) {
      writing(batch.database(), retirement_in(batch));
      return true;
    });
  }
  void run_writing_later(Writing writing) const override {
    const auto write = [writing = std::move(writing)](Batch& batch) {
      writing(batch.database(), retirement_in(batch));
      return true;
    };
    writer_->submit(std::make_unique<CallItem<decltype(write)>>(write));
  }

  template <typename Reported>
  void commit(std::vector<Reported> reported, ReportsDone done) {
    std::string why = out_of_space_reason();
    if (why.empty() && writer_->queued_bytes() > options_.max_queued_bytes)
      why = "the queue of reports is full, try again";
    if (!why.empty())
      return writer_->submit(
          ReportItem::declined(history_, put_off_, report_uuids(reported), std::move(done), why));
    const bool is_trim_due = admit_searches(reported);
    writer_->submit(std::make_unique<ReportItem>(history_, put_off_, std::move(reported),
                                                 std::move(done), options_.max_paths_per_pair));
    if (is_trim_due)
      trim_searches_later();
    take_ballast_later();
  }

  /// Through the writer's queue; returns when it is durable.
  template <typename Function>
  std::invoke_result_t<Function, Batch&> write(Function function) const {
    return answer_to(*writer_, std::make_unique<CallItem<Function>>(std::move(function)));
  }

  /// The rows; while the file is not the one that is named, as counted before.
  StoreStatus counted() const {
    const std::lock_guard lock(counted_mutex_);
    try {
      count();
    } catch (const Failure&) {
      if (!is_file_gone())
        count();  // it may have been, and the store is open again
    }
    return counted_;
  }
  void count() const try {
    const ReaderPool::Lease reader = readers_.lease();
    StoreStatus now;  // an exception leaves no half of a count
    count_rows(*reader, now);
    now.search_bytes = search_bytes(*reader);
    counted_ = std::move(now);
  } catch (const NotTheFile&) {  // or not any more: then it is back meanwhile
  }
  /// As of now: the writer looks before it answers.
  bool is_file_gone() const {
    try {
      write([](Batch&) { return true; });
    } catch (const Failure&) {  // which the watch tells, if it is that
    }
    return !watch_.trouble().empty();
  }

  /// Empty if reports are taken; else why not.
  std::string out_of_space_reason() const {
    if (std::string trouble = watch_.trouble(); !trouble.empty())
      return trouble;
    return store::out_of_space_reason(space_, *writer_, readers_, options_.max_wal_bytes);
  }

  void take_ballast_later() const {
    if (!space_.may_take_ballast())
      return;
    const auto take = [this](Batch& /*batch*/) {
      if (space_.may_take_ballast())
        space_.take_ballast();
      return true;
    };
    writer_->submit(std::make_unique<CallItem<decltype(take)>>(take));
  }

  std::vector<StoredPath> undamaged(PathsRead read) const {
    quarantine_later("path", std::move(read.damaged));
    return std::move(read.paths);
  }
  std::optional<RecordedScene> undamaged(SceneRead read, std::int64_t scene_id) const {
    if (read.damaged)
      quarantine_later("scene", {scene_id});
    return std::move(read.scene);
  }
  void quarantine_later(const char* table, std::vector<std::int64_t> damaged) const {
    if (!damaged.empty())
      writer_->submit(std::make_unique<DamageItem>(table, std::move(damaged)));
  }
  void quarantine_later(DamagedRows damaged) const {
    quarantine_later("path", std::move(damaged.paths));
    quarantine_later("scene", std::move(damaged.scenes));
    quarantine_later("attempt", std::move(damaged.attempts));
  }

  /// After a write failure no connection stays open, so that the WAL is read anew from the disk.
  std::unique_ptr<Database> reopen() {
    readers_.suspend();
    space_.release_ballast_if_short();
    try {
      watch_.require_named_closed();
      std::unique_ptr<Database> database = reopen_writer(file_);
      history_.begin_run(*database);
      watch_.note_opened(*database);
      readers_.resume();
      return database;
    } catch (const NotTheFile&) {
      throw;  // nor may anything be read then
    } catch (...) {
      readers_.resume();
      throw;
    }
  }

  const SqliteOptions options_;
  const std::filesystem::path file_;
  const StoreLock lock_;
  History history_;
  mutable ReaderPool readers_;
  FileWatch watch_;
  mutable DiskSpace space_;
  mutable PutOffReports put_off_{options_.put_off_for};
  mutable std::mutex counted_mutex_;
  mutable StoreStatus counted_;     // guarded by counted_mutex_
  std::unique_ptr<Writer> writer_;  // destroyed before all above, which it uses
  std::unique_ptr<Scrub> scrub_;    // and this before the writer
};

}  // namespace

std::unique_ptr<Store> open_sqlite_store(const std::filesystem::path& file,
                                         const SqliteOptions& options) {
  const std::string prefix = "store '";
  try {
    return std::make_unique<SqliteStore>(file, options);
  } catch (const SqliteError& error) {
    const std::string advice =
        error.is_damage() ? "; 'kinshipd repair' writes anew what can be read, 'kinshipd restore' "
                            "puts a backup in its place"
                          : "";
    throw Failure(error.code(), prefix + file.string() + "': " + error.what() + advice);
  } catch (const Failure& failure) {
    const Error& error = failure.error();
    if (error.message.starts_with(prefix))
      throw;
    throw Failure(error.code, prefix + file.string() + "': " + error.message);
  } catch (const std::filesystem::filesystem_error& error) {
    throw Failure(ErrorCode::Storage, prefix + file.string() + "': " + error.what());
  }
}

}  // namespace kinship::store
