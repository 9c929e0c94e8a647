#include "server/store/sqlite/sqlite_store.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "server/store/sqlite/attempt_rows.hpp"
#include "server/store/sqlite/call_item.hpp"
#include "server/store/sqlite/connection.hpp"
#include "server/store/sqlite/distribution_rows.hpp"
#include "server/store/sqlite/experience_rows.hpp"
#include "server/store/sqlite/export_rows.hpp"
#include "server/store/sqlite/listings.hpp"
#include "server/store/sqlite/lock_file.hpp"
#include "server/store/sqlite/path_rows.hpp"
#include "server/store/sqlite/reader_pool.hpp"
#include "server/store/sqlite/report_item.hpp"
#include "server/store/sqlite/retirement.hpp"
#include "server/store/sqlite/robot_rows.hpp"
#include "server/store/sqlite/scene_rows.hpp"
#include "server/store/sqlite/store_backup.hpp"
#include "server/store/sqlite/store_file.hpp"
#include "server/store/sqlite/transaction.hpp"
#include "server/store/sqlite/writer.hpp"

namespace kinship::store {
namespace {

/// Sets paths aside that a reader found damaged; if it fails, the next reader finds them again.
class DamageItem : public WriteItem {
 public:
  explicit DamageItem(std::vector<std::int64_t> paths) : paths_(std::move(paths)) {}

  void apply(Batch& batch) override { set_aside(batch, paths_); }
  void finish(const Error* /*error*/) override {}

 private:
  std::vector<std::int64_t> paths_;
};

Uuid ensure_epoch(Database& database) {
  Transaction transaction(database, Transaction::Kind::Write);
  database.cached("INSERT INTO setting VALUES ('epoch', ?) ON CONFLICT DO NOTHING")
      ->bind(1, std::string_view(Uuid::random().text()))
      .run();
  std::optional<Uuid> epoch;
  {
    const auto query = database.cached("SELECT value FROM setting WHERE key = 'epoch'");
    if (query->step())
      epoch = Uuid::parse(query->column_text(0));
  }
  transaction.commit();
  if (!epoch)
    throw Failure(ErrorCode::Storage, "its epoch is no UUID");
  return *epoch;
}

class SqliteStore : public Store {
 public:
  SqliteStore(const std::filesystem::path& file, const SqliteOptions& options)
      : options_(options), file_(locate_store(file)), lock_(file_), readers_(file_) {
    std::unique_ptr<Database> database = open_writer(file_);
    epoch_ = ensure_epoch(*database);
    writer_ = std::make_unique<Writer>(
        std::move(database), [this] { return reopen(); },
        WriterOptions{.retry_after = options.retry_after});
  }
  // Readers close before the writer does, whose last act is to empty the WAL.
  ~SqliteStore() override { readers_.suspend(); }

  Uuid epoch() const override { return epoch_; }

  StoreStatus status() const override {
    StoreStatus status;
    status.file = file_.string();
    status.epoch = epoch_;
    status.queued = writer_->queued();
    const std::string trouble = writer_->trouble();
    status.writable = trouble.empty();
    if (!trouble.empty())
      status.message = "not writable: " + trouble + "; ";
    const ReaderPool::Lease reader = readers_.lease();
    count_rows(*reader, status);
    if (const std::size_t damaged = damaged_robots_; damaged > 0)
      status.message += std::to_string(damaged) + " damaged robots left out; ";
    constexpr int kFixed = 3'051'003;
    if (sqlite3_libversion_number() < kFixed)
      status.message += std::string("SQLite ") + sqlite3_libversion() +
                        " is older than 3.51.3: no other program may write to the store; ";
    if (!status.message.empty())
      status.message.resize(status.message.size() - 2);
    return status;
  }

  Result<RegisterStatus> register_robot(const RobotRecord& robot) override {
    Result<RegisterStatus> result =
        write([&](Batch& batch) { return insert_robot(batch.database(), robot); });
    if (damaged_robots_ > 0)
      static_cast<void>(robots());  // counts again: this may have been one of them
    return result;
  }

  std::optional<RobotRecord> find_robot(const Digest& robot) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return select_robot(*reader, robot);
  }

  std::vector<RobotRecord> robots() const override {
    const ReaderPool::Lease reader = readers_.lease();
    RobotsRead read = select_robots(*reader);
    damaged_robots_ = read.damaged.size();
    return std::move(read.robots);
  }

  void commit_reports(std::vector<Attempt> attempts, ReportsDone done) override {
    if (writer_->queued_bytes() > options_.max_queued_bytes)
      writer_->submit(ReportItem::declined(attempts, std::move(done),
                                           "the queue of reports is full, try again"));
    else
      writer_->submit(std::make_unique<ReportItem>(std::move(attempts), std::move(done)));
  }

  std::vector<ExperienceSummary> experience(std::string_view task) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return experience_of(*reader, task);
  }

  std::uint64_t generation(const Digest& robot, std::string_view task) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return generation_of(*reader, robot, task);
  }

  std::vector<StoredPath> read_paths(const Digest& robot, std::string_view task,
                                     const PathRange& range) const override {
    const ReaderPool::Lease reader = readers_.lease();
    const std::optional<ExperienceKey> key = find_experience(*reader, robot, task);
    if (!key)
      return {};
    constexpr std::size_t kMaxPaths = 1'000'000;
    return undamaged(select_paths(
        *reader, *key, {range.after_id, std::min(range.limit, kMaxPaths), range.since_ms}));
  }

  std::optional<RecordedScene> read_scene(std::int64_t scene_id) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return undamaged(select_scene(*reader, scene_id), scene_id);
  }

  Result<Retirement> retire_path(const Uuid& report_uuid) override {
    return write([&](Batch& batch) { return store::retire_path(batch, report_uuid); });
  }

  Result<Retirement> reset_task(std::string_view task, const std::stop_token& stop) override {
    const Result<TaskReset> reset =
        write([&](Batch& batch) { return begin_reset(batch.database(), task); });
    if (!reset)
      return reset.error();
    Retirement retired;
    retired.task = task;
    while (write([&](Batch& batch) { return continue_reset(batch, *reset, retired); }))
      if (stop.stop_requested())
        return Error{ErrorCode::Unavailable, "task '" + retired.task +
                                                 "': the server is stopping after " +
                                                 std::to_string(retired.paths) +
                                                 " paths were retired; ask again for the others"};
    return retired;
  }

  AttemptTotals attempt_totals(const Digest& robot, std::string_view task) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return totals_of(*reader, robot, task);
  }

  std::uint64_t put_distribution(const Distribution& distribution) override {
    return write([&](Batch& batch) { return upsert_distribution(batch.database(), distribution); });
  }

  bool evict_distribution(const Digest& id) override {
    return write([&](Batch& batch) { return delete_distribution(batch.database(), id); });
  }

  std::optional<Distribution> find_distribution(const Digest& id) const override {
    const ReaderPool::Lease reader = readers_.lease();
    std::optional<Distribution> distribution = select_distribution(*reader, id).distribution;
    if (distribution)
      distribution->store_epoch = epoch_;
    return distribution;
  }

  Page<RobotSummary> list_robots(std::string_view cursor, std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_robots(*reader, cursor, limit);
  }

  Page<TaskSummary> list_tasks(std::string_view cursor, std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_tasks(*reader, cursor, limit);
  }

  std::optional<TaskSummary> find_task(std::string_view task) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return summary_of_task(*reader, task);
  }

  Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                               std::string_view cursor, std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_paths(*reader, robot, task, cursor, limit);
  }

  std::optional<Attempt> find_attempt(const Uuid& report_uuid) const override {
    const ReaderPool::Lease reader = readers_.lease();
    std::optional<AttemptRow> row = select_attempt(*reader, report_uuid);
    if (!row)
      return std::nullopt;
    if (row->path_id)
      for (StoredPath& stored : undamaged(select_path(*reader, *row->path_id)))
        row->attempt.path = std::move(stored.path);
    if (row->scene_id)
      row->attempt.scene = undamaged(select_scene(*reader, *row->scene_id), *row->scene_id);
    return std::move(row->attempt);
  }

  Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                std::string_view cursor, std::size_t limit,
                                std::size_t max_bytes) const override {
    const ReaderPool::Lease reader = readers_.lease();
    ExportRead read = export_page(*reader, robot, task, cursor, limit, max_bytes);
    set_aside_later(std::move(read.damaged));
    for (const std::int64_t scene : read.damaged_scenes)
      set_scene_aside_later(scene);
    return std::move(read.page);
  }

  Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                               std::string_view task, std::string_view cursor,
                                               std::size_t limit) const override {
    const ReaderPool::Lease reader = readers_.lease();
    return page_of_distributions(*reader, robot, task, cursor, limit);
  }

  Result<bool> backup(const std::filesystem::path& file,
                      const std::function<bool(double)>& progress) const override {
    return back_up(*writer_, file, progress);
  }

 private:
  /// Through the writer's queue; returns when it is durable.
  template <typename Function>
  std::invoke_result_t<Function, Batch&> write(Function function) {
    auto item = std::make_unique<CallItem<Function>>(std::move(function));
    auto result = item->result();
    writer_->submit(std::move(item));
    return result.get();
  }

  std::vector<StoredPath> undamaged(PathsRead read) const {
    set_aside_later(std::move(read.damaged));
    return std::move(read.paths);
  }
  std::optional<RecordedScene> undamaged(SceneRead read, std::int64_t scene_id) const {
    if (read.damaged)
      set_scene_aside_later(scene_id);
    return std::move(read.scene);
  }
  void set_scene_aside_later(std::int64_t scene_id) const {
    const auto set_aside = [scene_id](Batch& batch) {
      set_scene_aside(batch.database(), scene_id);
      return true;
    };
    writer_->submit(std::make_unique<CallItem<decltype(set_aside)>>(set_aside));
  }
  void set_aside_later(std::vector<std::int64_t> damaged) const {
    if (!damaged.empty())
      writer_->submit(std::make_unique<DamageItem>(std::move(damaged)));
  }

  /// After a write failure nobody keeps the file open, so that the WAL is read anew from the disk.
  std::unique_ptr<Database> reopen() {
    readers_.suspend();
    try {
      std::unique_ptr<Database> database = reopen_writer(file_);
      readers_.resume();
      return database;
    } catch (...) {
      readers_.resume();
      throw;
    }
  }

  const SqliteOptions options_;
  const std::filesystem::path file_;
  const LockFile lock_;
  mutable ReaderPool readers_;
  Uuid epoch_;
  mutable std::atomic<std::size_t> damaged_robots_ = 0;
  std::unique_ptr<Writer> writer_;  // destroyed first: it uses all above
};

}  // namespace

std::unique_ptr<Store> open_sqlite_store(const std::filesystem::path& file,
                                         const SqliteOptions& options) {
  const std::string prefix = "store '";
  try {
    return std::make_unique<SqliteStore>(file, options);
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
