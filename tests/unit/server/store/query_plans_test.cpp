#include <gtest/gtest.h>
#include <sqlite3.h>

#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/statement.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// What SQLite does for the statements that a serving store runs: none of them reads what other
/// robots and tasks have, however much that is.
namespace kinship::store::query_plans_test {
namespace {

/// The texts of all statements that any connection of this process runs while it lives.
class Recorder {
 public:
  Recorder() { sqlite3_auto_extension(entry()); }
  ~Recorder() { sqlite3_cancel_auto_extension(entry()); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void begin(const std::string& what) {
    const std::lock_guard lock(mutex());
    current() = what;
  }
  /// By text, the first question that ran it.
  static std::map<std::string, std::string>& statements() {
    static std::map<std::string, std::string> texts;
    return texts;
  }

 private:
  static std::mutex& mutex() {
    static std::mutex guard;
    return guard;
  }
  static std::string& current() {
    static std::string what;
    return what;
  }
  static int record(unsigned /*event*/, void* /*context*/, void* /*statement*/, void* text) {
    const std::lock_guard lock(mutex());
    if (!current().empty())
      statements().try_emplace(static_cast<const char*>(text), current());
    return 0;
  }
  static int watch(sqlite3* database, const char** /*error*/, const void* /*routines*/) {
    return sqlite3_trace_v2(database, SQLITE_TRACE_STMT, record, nullptr);
  }
  static void (*entry())() { return reinterpret_cast<void (*)()>(watch); }
};

/// Whether a step reads all of a table or an index that grows with what the fleet reports (the
/// others grow with robots and tasks), or sorts.
bool is_costly(const std::string& step) {
  for (const char* const name :
       {"path", "attempt", "newest", "scene", "distribution ", "set_aside", "audit"})
    if (step.starts_with("SCAN " + std::string(name)))
      return true;
  return step.find("TEMP B-TREE") != std::string::npos;
}

class QueryPlans : public testing::Test {
 protected:
  QueryPlans() {
    store_ = open_sqlite_store(file_, {.max_distribution_bytes = 6000, .max_paths_per_pair = 4});
    for (const RobotRecord& robot : {panda_, test::make_robot("iiwa", 2)})
      static_cast<void>(store_->register_robot(robot));
  }
  void ask(const std::string& what, const std::function<void()>& question) {
    recorder_.begin(what);
    question();
    test::report(*store_, {});  // what a reading left to the writer is done
    recorder_.begin("");
  }
  /// The steps of a statement's plan that read more than they should.
  std::vector<std::string> faults(Database& database, const std::string& sql) const {
    Statement plan(database.connection(), "EXPLAIN QUERY PLAN " + sql);
    std::vector<std::string> found;
    while (plan.step())
      if (std::string step(plan.column_text(3)); is_costly(step))
        found.push_back(std::move(step));
    return found;
  }

  Recorder recorder_;
  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "store.db";
  const RobotRecord panda_ = test::make_robot("panda", 1);
  std::unique_ptr<Store> store_;
};

TEST_F(QueryPlans, NoStatementOfAServingStoreReadsWhatOthersHave) {
  const Digest robot = panda_.digest;
  const std::string task = "shelf";
  ask("reports", [&] {
    for (std::uint64_t number = 1; number < 40; ++number) {
      Attempt attempt = test::make_attempt(robot, task, number);
      if (number % 2 == 0)
        attempt.scene = RecordedScene{{{"table", BoxShape{{1, 1, 0.1}}}}, {}, {}};
      test::report(*store_, {attempt, test::make_unsolved(robot, task, 1000 + number)});
      test::report(*store_, {attempt});
    }
  });
  const std::vector<StoredPath> paths =
      store_->read_paths(robot, task, {.after_id = 0, .limit = 10});
  ASSERT_EQ(paths.size(), 4U);
  ask("a fit", [&] {
    store_->experience(task);
    store_->generation(robot, task);
    store_->path_ids(robot, task);
    store_->attempt_totals(robot, task);
    for (const StoredPath& path : store_->read_paths(robot, task, {0, 10, 5}))
      if (path.scene_id)
        store_->read_scene(*path.scene_id);
    for (std::uint64_t number = 1; number < 9; ++number)
      store_->put_distribution(test::make_distribution(robot, task, number));
  });
  ask("a fetch", [&] {
    EXPECT_TRUE(store_->find_distribution(test::id_from<Digest>(8)));
    store_->note_use(test::id_from<Digest>(8));
    store_->find_robot(robot);
  });
  ask("listings", [&] {
    store_->list_robots("", 1);
    store_->list_robots("iiwa", 1);
    store_->list_tasks("", 1);
    store_->find_task(task);
    store_->list_paths(robot, task, "", 2);
    store_->list_paths({}, "", "2", 2);
    store_->list_attempts({}, "", "", 2);
    store_->list_attempts(robot, task, "", 2);
    store_->list_distributions({}, "", "", 2);
    store_->list_distributions(robot, task, "", 2);
    store_->list_distributions({}, task, "", 2);
    store_->list_distributions(robot, "", "", 2);
    store_->find_attempt(paths[0].report_uuid);
    store_->list_audit("", "", 2);
    store_->list_audit("anna", "7", 2);
    store_->export_attempts({}, "", "", 2, 1'000'000);
    store_->export_attempts(robot, task, "", 2, 1'000'000);
  });
  ask("retirement", [&] {
    AuditEntry audit;
    audit.verb = "act";
    static_cast<void>(store_->retire_path(paths[0].report_uuid, &audit));
    static_cast<void>(store_->reset_task(task, {}, &audit));
    store_->evict_distribution(test::id_from<Digest>(8), &audit);
    static_cast<void>(store_->rename_robot(robot, "panda_2", &audit));
    static_cast<void>(store_->remove_robot(robot, {}, &audit));
  });
  store_.reset();
  Database database(file_, Access::ReadOnly);
  std::size_t explained = 0;
  for (const auto& [sql, what] : Recorder::statements()) {
    if (!sql.starts_with("SELECT") && !sql.starts_with("UPDATE") && !sql.starts_with("DELETE"))
      continue;
    ++explained;
    const std::vector<std::string> found = faults(database, sql);
    EXPECT_TRUE(found.empty()) << what << ": " << testing::PrintToString(found) << "\n  " << sql;
  }
  EXPECT_GT(explained, 50U) << "the recorder hears them";
}

}  // namespace
}  // namespace kinship::store::query_plans_test
