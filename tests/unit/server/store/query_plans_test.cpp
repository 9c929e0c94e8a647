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
#include "tests/unit/server/store/every_question.hpp"

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
       {"path", "attempt", "newest", "scene", "distribution ", "quarantine", "audit"})
    if (step.starts_with("SCAN " + std::string(name)))
      return true;
  return step.find("TEMP B-TREE") != std::string::npos;
}

class QueryPlans : public testing::Test {
 protected:
  QueryPlans() {
    store_ = open_sqlite_store(file_, {.max_distribution_bytes = 6000,
                                       .max_paths_per_pair = EveryQuestion::kPathsOfAPair,
                                       .scrub_bytes_per_s = 0});  // it reads everything
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
  EveryQuestion questions(*store_, panda_.digest, 1,
                          [this](const std::string& what, const std::function<void()>& question) {
                            ask(what, question);
                          });
  ASSERT_NO_FATAL_FAILURE(questions.ask_all());
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
