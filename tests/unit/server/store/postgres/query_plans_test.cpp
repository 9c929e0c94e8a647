#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/store/every_question.hpp"

/// What PostgreSQL does for the statements that a serving store runs, as it did it: none of them
/// reads what other robots and tasks have, however much that is.
namespace kinship::store::postgres_plans_test {
namespace {

using nlohmann::json;

/// The tables that grow with what the fleet reports; the others grow with robots and tasks.
const std::set<std::string> kLarge = {"path",         "attempt",          "scene",         "audit",
                                      "distribution", "distribution_use", "retired_report"};

/// What is allowed to read all of a table, by how the statement ends: a few bytes for each
/// distribution, for the status, and where one is stored and there is a limit for all of them.
const std::set<std::string> kWholeTables = {"FROM distribution_use"};

/// Far more than any question here is about, far less than the tables hold.
constexpr double kMostRowsRead = 600;
constexpr double kPagesOfAScan = 12, kPagesOfARow = 4;

/// Robots and tasks that nobody asks for, with much of everything.
constexpr const char* kOthers = R"sql(
SET auto_explain.log_min_duration = -1;
INSERT INTO robot (digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes,
  registered_ms, crc32c, urdf)
  SELECT sha256(n::text::bytea), 'other_' || n, 3, 'base', 'tip',
    decode(repeat('00', 56), 'hex'), 0, 1, 0, '' FROM generate_series(1, 30) AS n;
INSERT INTO task (name) SELECT 'task_' || n FROM generate_series(1, 30) AS n;
INSERT INTO experience (task_id, robot_id, generation, paths, attempts)
  SELECT task.id, robot.id, 1, 1, 1 FROM task CROSS JOIN robot;
INSERT INTO scene (content_sha256, received_ms, size, encoding, crc32c, scene)
  SELECT sha256(n::text::bytea), 1, 1, 1, 0, '\x00' FROM generate_series(1, 10000) AS n;
INSERT INTO path (task_id, robot_id, report_uuid, content_sha256, waypoint_count, dof, length,
  received_ms, retired_ms, encoding, crc32c, waypoints)
  SELECT 1 + n % 30, 1 + n / 30 % 30, substr(sha256(n::text::bytea), 1, 16),
    sha256(n::text::bytea), 20, 3, 1, 1, CASE WHEN n % 5 = 0 THEN 1 END, 2, 0, '\x0102'
  FROM generate_series(1, 20000) AS n;
INSERT INTO attempt (report_uuid, body_sha256, task_id, robot_id, path_id, status, machine, outcome,
  planner, planner_options, planning_time_s, collision_checks, projections, time_limit_s, sampling_mode, share,
  distribution_revision, received_ms)
  SELECT substr(sha256((-n)::text::bytea), 1, 16), sha256(''), 1 + n % 30, 1 + n / 30 % 30,
    NULL::bigint, 3, 'cell', 2, 'rrt', '', 1, 1, 0, 1, 2, 0, 0, 1
  FROM generate_series(1, 20000) AS n UNION ALL
  SELECT report_uuid, sha256(''), task_id, robot_id, id, 1, 'cell', 1, 'rrt', '', 1, 1, 0, 1, 2, 0,
    0, 1 FROM path;
INSERT INTO distribution (digest, revision, task_id, robot_id, profile, state, reason, components,
  configurations, paths, fitted_ms, crc32c, payload)
  SELECT sha256(n::text::bytea), 1, 1 + n % 30, 1 + n / 30 % 30, 'default', 2, '', 0, 0, 0, 1, 0,
    '\x00' FROM generate_series(1, 10000) AS n;
INSERT INTO distribution_use (id, used_ms, bytes) SELECT id, 4000000000000, 1 FROM distribution;
INSERT INTO retired_report (report_uuid, retired_ms)
  SELECT substr(sha256(('r' || n)::bytea), 1, 16), 1 FROM generate_series(1, 10000) AS n;
INSERT INTO audit (time_ms, name, role, client, is_local, verb, target, outcome, was, became, message)
  SELECT 1, 'name_' || n % 100, 'operator', 'client', 0, 'act', 'thing', 2, '', '', ''
  FROM generate_series(1, 10000) AS n;
)sql";

class PostgresPlans : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    cluster_ = std::make_unique<test::PostgresCluster>(test::PostgresCluster::Options{
        .name = "plans",
        .settings = {"session_preload_libraries = 'auto_explain'",
                     "auto_explain.log_min_duration = 0", "auto_explain.log_analyze = on",
                     "auto_explain.log_timing = off", "auto_explain.log_format = 'json'",
                     "auto_explain.log_buffers = on",
                     "auto_explain.log_nested_statements = on"}});  // those of foreign keys
    url_ = cluster_->create_database("store");
    open();
    cluster_->query(kOthers, "store");
    cluster_->query("VACUUM ANALYZE", "store");
  }
  void open() {
    store_.reset();
    store_ = open_postgres_store(
        url_, {.max_distribution_bytes = 8000, .max_paths_per_pair = EveryQuestion::kPathsOfAPair});
  }

  /// Asks, and looks at the plans of what the store ran for that.
  void ask(const std::string& what, const std::function<void()>& question) {
    const std::uintmax_t begin = std::filesystem::file_size(cluster_->log());
    question();
    test::report(*store_, {});  // what a reading left to the writer is done
    for (const json& explained : plans_since(begin)) {
      const std::string text = explained.at("Query Text");
      statements_.insert(text);
      if (std::ranges::any_of(kWholeTables,
                              [&](const std::string& end) { return text.ends_with(end); }))
        continue;
      std::vector<std::string> faults;
      find_faults(explained.at("Plan"), faults);
      EXPECT_TRUE(faults.empty()) << what << ": " << testing::PrintToString(faults) << "\n  "
                                  << text << "\n"
                                  << explained.at("Plan").dump(1);
    }
  }
  /// A path and a scene that are damaged, noticed, and mended by a report.
  void ask_about_damage(const Digest& robot, std::uint64_t number) {
    Attempt attempt = test::make_attempt(robot, "damaged", number);
    attempt.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}}}, {}, {}};
    test::report(*store_, {attempt});
    const std::vector<StoredPath> paths = store_->read_paths(robot, "damaged", {0, 10, 0});
    ASSERT_EQ(paths.size(), 1U);
    cluster_->query(
        "UPDATE path SET crc32c = 1 WHERE id = " + std::to_string(paths[0].id) +
            "; UPDATE scene SET crc32c = 1 WHERE id = " + std::to_string(paths[0].scene_id.value()),
        "store");
    ask("damage", [&] {
      EXPECT_TRUE(store_->read_paths(robot, "damaged", {0, 10, 0}).empty());
      EXPECT_FALSE(store_->read_scene(*paths[0].scene_id));
    });
    EXPECT_TRUE(store_->status().damaged);
    ask("mending", [&] { test::report(*store_, {attempt}); });
    EXPECT_FALSE(store_->status().damaged);
  }
  std::size_t statements() const { return statements_.size(); }

  std::unique_ptr<test::PostgresCluster> cluster_;
  std::string url_;
  std::unique_ptr<Store> store_;

 private:
  /// What the log has from there on. Lines that belong to the one before begin with a tab.
  std::vector<json> plans_since(std::uintmax_t begin) const {
    std::ifstream log(cluster_->log());
    log.seekg(static_cast<std::streamoff>(begin));
    std::vector<json> plans;
    std::string line, text;
    const auto take = [&] {
      if (!text.empty())
        plans.push_back(json::parse(text));
      text.clear();
    };
    bool is_plan = false;
    while (std::getline(log, line)) {
      if (line.starts_with('\t')) {
        if (is_plan)
          text += line;
        continue;
      }
      take();
      is_plan = line.ends_with("plan:");
    }
    take();
    return plans;
  }

  /// Rows that a scan looked at, and pages: an index that is read through gives few rows.
  static void find_faults(const json& node, std::vector<std::string>& faults) {
    const std::string type = node.at("Node Type");
    const std::string table = node.value("Relation Name", "");
    if (kLarge.contains(table) && type.ends_with("Scan")) {
      const double times = node.value("Actual Loops", 1.0);
      const double rows =
          times * (node.value("Actual Rows", 0.0) + node.value("Rows Removed by Filter", 0.0) +
                   node.value("Rows Removed by Index Recheck", 0.0));
      const double pages =
          node.value("Shared Hit Blocks", 0.0) + node.value("Shared Read Blocks", 0.0);
      if (type == "Seq Scan" || rows > kMostRowsRead ||
          pages > kPagesOfAScan * times + kPagesOfARow * rows)
        faults.push_back(type + " on " + table + ": " + std::to_string(rows) + " rows, " +
                         std::to_string(pages) + " pages");
    }
    if (const auto children = node.find("Plans"); children != node.end())
      for (const json& child : *children)
        find_faults(child, faults);
  }

  std::set<std::string> statements_;
};

TEST_F(PostgresPlans, NoStatementOfAServingStoreReadsWhatOthersHave) {
  const RobotRecord panda = test::make_robot("panda", 1);
  std::uint64_t first_number = 1;
  // Once as PostgreSQL plans for the values, once as it does for statements that came often.
  for (const char* const mode : {"force_custom_plan", "force_generic_plan"}) {
    cluster_->set("plan_cache_mode", mode);
    open();
    ask("registration", [&] {
      for (const RobotRecord& each : {panda, test::make_robot("iiwa", 2)})
        EXPECT_TRUE(store_->register_robot(each));
    });
    ASSERT_NO_FATAL_FAILURE(ask_about_damage(panda.digest, first_number + 9000));
    EveryQuestion questions(*store_, panda.digest, first_number,
                            [this](const std::string& what, const std::function<void()>& question) {
                              ask(what, question);
                            });
    ask("the status", [&] { EXPECT_TRUE(store_->status().writable); });
    ASSERT_NO_FATAL_FAILURE(questions.ask_all());
    first_number += 10'000;
  }
  EXPECT_GT(statements(), 50U) << "the log has them";
}

}  // namespace
}  // namespace kinship::store::postgres_plans_test
