#include "server/store/postgres/postgres_store.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

#include "server/store/postgres/copying/sqlite_copy.hpp"
#include "server/store/postgres/database/connection_pool.hpp"
#include "server/store/postgres/durable_writes.hpp"
#include "server/store/postgres/fit_reads.hpp"
#include "server/store/postgres/opening/history.hpp"
#include "server/store/postgres/opening/opening.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/postgres/presence.hpp"
#include "server/store/postgres/report_writer.hpp"
#include "server/store/postgres/rows/arrivals.hpp"
#include "server/store/postgres/rows/export_rows.hpp"
#include "server/store/postgres/rows/fit_lease_rows.hpp"
#include "server/store/postgres/rows/listings.hpp"
#include "server/store/postgres/rows/retirement.hpp"
#include "server/store/sql_store.hpp"
#include "server/store/tables/contents.hpp"
#include "server/store/tables/distributions.hpp"

namespace kinship::store::postgres {
namespace {

class PostgresStore : public SqlStore {
 public:
  PostgresStore(const std::string& url, const PostgresOptions& options)
      : SqlStore(options.max_distribution_bytes, options.searches),
        options_(options),
        primary_(ConnectionString(url), {.patience = options.patience, .interrupt = &interrupt_}),
        readers_([this] { return primary_.connect(); }),
        writes_([this] { return primary_.connect(); }, options.require_synchronous) {
    std::unique_ptr<Connection> connection = begin_store(primary_, history_, presence_.server());
    fit_reads_.run_began(history_.run(), timeline_of(*connection));
    writer_ = std::make_unique<ReportWriter>(
        primary_, history_, std::move(connection),
        ReportWriterOptions{.max_paths_per_pair = options.max_paths_per_pair,
                            .require_synchronous = options.require_synchronous,
                            .retry_after = options.retry_after,
                            .put_off_for = options.put_off_for,
                            .log = options.log},
        [this](Connection& anew) { connected(anew); });
    writer_->set_interrupt(interrupt_);
  }

  void stop_waiting() noexcept override { interrupt_.raise(); }

  Uuid epoch() const override { return history_.epoch(); }
  StorePoint point() const override { return history_.point(); }

  bool has_lost(const ConsistencyToken& token) const override {
    const std::optional<LogPosition> unconfirmed = history_.find_unconfirmed(token);
    if (!unconfirmed)
      return false;
    try {
      return readers_.read(
          [&](Connection& connection) { return history_.is_gone(connection, *unconfirmed); });
    } catch (const PostgresError&) {
      return false;  // the database's answer is not known now
    }
  }

  bool may_have_lost(const ConsistencyToken& token) const override {
    return history_.find_unconfirmed(token).has_value();
  }

  bool begin_epoch_if_lost(const ConsistencyToken& token) override {
    const auto begun = writes_.write(
        [&](Connection& connection) { return history_.begin_epoch_if_lost(connection, token); });
    if (begun)
      history_.adopt(*begun);
    return begun.has_value();
  }

  StoreStatus status() const override {
    const std::string trouble = writer_->trouble();
    StoreStatus status;
    if (trouble.empty())
      count(status);
    else
      status = last_counts();
    status.file = primary_.description();
    status.epoch = history_.epoch();
    status.rollbacks = history_.rollbacks();
    status.queued = writer_->queued();
    status.replicas = fit_reads_.use();
    status.max_paths_per_pair = options_.max_paths_per_pair;
    status.max_distribution_bytes = options_.max_distribution_bytes;
    status.max_search_bytes = options_.searches.bytes;
    if (status.rollbacks > 0)
      status.message = "rolled back, clients offer again what is missing: " + history_.trouble() +
                       "; " + status.message;
    if (const std::string told = writer_->put_off().told(); !told.empty())
      status.message += told + "; ";
    if (const std::size_t damaged = damaged_robots(); damaged > 0)
      status.message += std::to_string(damaged) + " damaged robots left out; ";
    status.damaged = status.damaged || damaged_robots() > 0;
    if (!trouble.empty()) {
      status.writable = false;
      status.message = "not writable: " + trouble + "; " + status.message;
    }
    if (!status.message.empty())
      status.message.resize(status.message.size() - 2);
    return status;
  }

  void commit_reports(std::vector<Attempt> attempts, ReportsDone done) override {
    commit(std::move(attempts), std::move(done));
  }

  Feed<ArrivedReport> list_arrivals(std::string_view task, std::string_view cursor,
                                    std::size_t limit) const override {
    return readers_.read(
        [&](Connection& connection) { return feed_of_arrivals(connection, task, cursor, limit); });
  }

  Feed<Uuid> list_retirements(std::string_view cursor, std::size_t limit) const override {
    return readers_.read(
        [&](Connection& connection) { return feed_of_retirements(connection, cursor, limit); });
  }

  std::map<Uuid, Digest> known_reports(std::span<const Uuid> reports) const override {
    return readers_.read([&](Connection& connection) { return select_known(connection, reports); });
  }

  ReplicatedReports read_reports(std::span<const Uuid> reports,
                                 std::size_t max_bytes) const override {
    ReplicatedRead read = readers_.read_snapshot(
        [&](Connection& connection) { return select_replicated(connection, reports, max_bytes); });
    quarantine_later(std::move(read.damaged));
    return std::move(read.found);
  }

  void commit_replicated(std::vector<ReplicatedReport> reports, ReportsDone done) override {
    commit(std::move(reports), std::move(done));
  }

  std::optional<std::string> why_put_off(const Uuid& report) const override {
    return writer_->put_off().find(report);
  }

  std::vector<Retirement> retire_reports(std::span<const Uuid> reports) override {
    return writes_.write(
        [&](Connection& connection) { return postgres::retire_reports(connection, reports); });
  }

  std::vector<StoredPath> read_paths(const Digest& robot, std::string_view task,
                                     const PathRange& range) const override {
    PathsRead read = fit_reads_.paths(robot, task, range);
    quarantine_later({.paths = std::move(read.damaged)});
    return std::move(read.paths);
  }

  std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                     std::uint64_t generation) const override {
    return fit_reads_.path_ids(robot, task, generation);
  }

  std::optional<RecordedScene> read_scene(std::int64_t scene_id) const override {
    SceneRead read = fit_reads_.scene(scene_id);
    if (read.damaged)
      quarantine_later({.scenes = {scene_id}});
    return std::move(read.scene);
  }

  Result<Retirement> retire_path(const Uuid& report_uuid, const AuditEntry* audit) override {
    return writes_.write([&](Connection& connection) {
      return postgres::retire_path(connection, report_uuid, audit);
    });
  }

  bool is_shared() const override { return true; }
  std::optional<StoreChanges> changes_since(std::string_view cursor) const override {
    return presence_.changes_since(cursor);
  }
  std::optional<FitRight> take_fit_right(const Digest& id) override {
    return presence_.take_fit_right(id);
  }
  void give_back_fit_right(const Digest& id, const FitRight& right) noexcept override {
    presence_.give_back_fit_right(id, right);
  }

  void note_use(const Digest& id) const override {
    write_later([id](Connection& connection) { store::note_use(connection, id); });
  }

  Page<PathSummary> list_paths(const std::optional<Digest>& robot, std::string_view task,
                               std::string_view cursor, std::size_t limit) const override {
    return readers_.read([&](Connection& connection) {
      return page_of_paths(connection, {robot, task}, cursor, limit);
    });
  }

  Page<AttemptSummary> list_attempts(const std::optional<Digest>& robot, std::string_view task,
                                     std::string_view cursor, std::size_t limit) const override {
    return readers_.read_snapshot([&](Connection& connection) {
      return page_of_attempts(connection, {robot, task}, cursor, limit);
    });
  }

  std::optional<Attempt> find_attempt(const Uuid& report_uuid) const override {
    DamagedRows noticed;
    std::optional<Attempt> attempt = readers_.read_snapshot([&](Connection& connection) {
      noticed = {};
      return postgres::find_attempt(connection, report_uuid, noticed);
    });
    quarantine_later(std::move(noticed));
    return attempt;
  }

  Page<Attempt> export_attempts(const std::optional<Digest>& robot, std::string_view task,
                                std::string_view cursor, std::size_t limit,
                                std::size_t max_bytes) const override {
    DamagedRows noticed;
    Page<Attempt> page = readers_.read_snapshot([&](Connection& connection) {
      noticed = {};
      return export_page(connection, {robot, task}, cursor, limit, max_bytes, noticed);
    });
    quarantine_later(std::move(noticed));
    return page;
  }

  Page<DistributionSummary> list_distributions(const std::optional<Digest>& robot,
                                               std::string_view task, std::string_view cursor,
                                               std::size_t limit) const override {
    return readers_.read([&](Connection& connection) {
      return page_of_distributions(connection, {robot, task}, cursor, limit);
    });
  }

  Result<bool> backup(const std::filesystem::path& file,
                      const std::function<bool(double)>& progress) const override {
    if (is_backing_up_.exchange(true))
      return Error{ErrorCode::Unavailable,
                   "backup '" + file.string() + "': another backup is on its way"};
    const std::unique_ptr<std::atomic<bool>, void (*)(std::atomic<bool>*)> end(
        &is_backing_up_, [](std::atomic<bool>* on_its_way) { on_its_way->store(false); });
    // On a connection of its own: it reads for as long as it takes.
    return copy_to_sqlite(*primary_.connect(), file, progress);
  }

 private:
  void run_reading(View view, const Reading& reading) const override {
    const auto run = [&](Connection& connection) {
      reading(connection);
      return true;
    };
    if (view == View::Snapshot)
      readers_.read_snapshot(run);
    else
      readers_.read(run);
  }
  void run_writing(const Writing& writing) override {
    writes_.write([&](Connection& connection) {
      writing(connection, retirement_in(connection));
      return true;
    });
  }
  void run_writing_later(Writing writing) const override {
    write_later([writing = std::move(writing)](Connection& connection) {
      writing(connection, retirement_in(connection));
    });
  }
  void require_fit_right(Session& session, const Digest& distribution,
                         const FitRight& right) override {
    if (right.fence > 0 && !has_fit_right(static_cast<Connection&>(session), distribution, right))
      throw Failure(ErrorCode::Unavailable,
                    "distribution " + distribution.short_hex() + ": another server fits it");
  }

  template <typename Reported>
  void commit(std::vector<Reported> reported, ReportsDone done) {
    if (writer_->queued_bytes() <= options_.max_queued_bytes) {
      const bool is_trim_due = admit_searches(reported);
      writer_->submit(prepare_item(std::move(reported), std::move(done), writer_->put_off()));
      if (is_trim_due)
        trim_searches_later();
      return;
    }
    writer_->submit(declined_item(report_uuids(reported), std::move(done),
                                  "the queue of reports is full, try again"));
  }

  /// On the writer's thread; no caller waits for it.
  void write_later(std::function<void(Connection&)> function) const {
    QueuedItem item;
    item.write = std::move(function);
    writer_->submit(std::move(item));
  }

  void quarantine_later(DamagedRows noticed) const {
    if (noticed.paths.empty() && noticed.scenes.empty())
      return;
    write_later([noticed = std::move(noticed)](Connection& connection) {
      quarantine(connection, noticed);
    });
  }

  /// The database's counts, or the last ones it gave.
  void count(StoreStatus& status) const {
    try {
      readers_.read([&](Connection& connection) {
        status = {};
        count_rows(connection, status);
        status.search_bytes = search_bytes(connection);
        return true;
      });
    } catch (const PostgresError& error) {
      status = last_counts();
      status.writable = false;
      status.message = std::string("the database does not answer: ") + error.what() + "; ";
      return;
    }
    const std::lock_guard lock(mutex_);
    counts_ = status;
  }

  StoreStatus last_counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

  /// The writer has found the primary anew: others may still hold on to the old one.
  void connected(Connection& anew) {
    readers_.forget();
    writes_.forget();
    fit_reads_.run_began(history_.run(), timeline_of(anew));
  }

  const PostgresOptions options_;
  Interrupt interrupt_;
  mutable Primary primary_;
  History history_;
  mutable ConnectionPool readers_;
  DurableWrites writes_;
  mutable FitReads fit_reads_{primary_, readers_, options_.read_replicas};
  mutable Presence presence_{readers_};
  mutable std::atomic<bool> is_backing_up_ = false;
  mutable std::mutex mutex_;
  mutable StoreStatus counts_;            // guarded by mutex_
  std::unique_ptr<ReportWriter> writer_;  // destroyed before all above, which it uses
};

}  // namespace
}  // namespace kinship::store::postgres

namespace kinship::store {

std::unique_ptr<Store> open_postgres_store(const std::string& url, const PostgresOptions& options) {
  std::string name = "store";
  try {
    name += " '" + postgres::ConnectionString(url).description() + "'";
    return std::make_unique<postgres::PostgresStore>(url, options);
  } catch (const Failure& failure) {
    throw Failure(failure.code(), name + ": " + failure.what());
  }
}

}  // namespace kinship::store
