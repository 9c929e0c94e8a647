// A PostgreSQL database of many paths in many (robot, task) pairs: what a million paths take, what
// reading, listing and reporting to one pair costs beside a database that has that pair alone, and
// vacuum. The first pair is reported; the others are copies of its rows, made in the database, each
// with two waypoints: what waypoints take is measured at the first one.
//
//   large_postgres_bench PATHS PAIRS      10000000 1000: 15 GB, half an hour

#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/filled_store.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/store_questions.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::bench {
namespace {

constexpr double kMB = 1e6, kMillion = 1e6;
constexpr std::uint64_t kFirstLater = 1'000'000'000;  // beyond the paths of a pair

/// The first pair's rows again for as many others as are behind `first`, by the order of their
/// keys.
std::string copies_sql(std::uint64_t first, std::uint64_t count) {
  std::ostringstream sql;
  sql << R"(SET synchronous_commit = off; SET session_replication_role = replica;
    CREATE TEMP TABLE target AS SELECT task_id, robot_id FROM experience
      WHERE robot_id <> (SELECT id FROM robot WHERE label = ')"
      << Fleet::kAlone << "') ORDER BY task_id, robot_id OFFSET " << first << " LIMIT " << count
      << R"(;
    INSERT INTO path (task_id, robot_id, report_uuid, content_sha256, waypoint_count, dof, length,
        received_ms, T_task_base, encoding, crc32c, waypoints)
      SELECT target.task_id, target.robot_id, substring(content, 1, 16), content, 2, path.dof, length,
          received_ms, T_task_base, 1, path.crc32c, decode(repeat('00', 16 * path.dof::int), 'hex')
        FROM target, path JOIN robot ON robot.id = path.robot_id, LATERAL (
          SELECT sha256(int8send(path.id) || int8send(target.task_id) || int8send(target.robot_id))
            AS content) AS made
        WHERE robot.label = ')"
      << Fleet::kAlone << R"(';
    INSERT INTO attempt (report_uuid, body_sha256, task_id, robot_id, path_id, status, machine,
        T_task_base, outcome, planner, planner_options, planning_time_s, collision_checks,
        projections, time_limit_s, arm, share, distribution_digest, distribution_revision,
        received_ms)
      SELECT path.report_uuid, path.content_sha256, path.task_id, path.robot_id, path.id, 1,
          machine, a.T_task_base, outcome, planner, planner_options, planning_time_s,
          collision_checks, projections, time_limit_s, arm, share, distribution_digest,
          distribution_revision, a.received_ms
        FROM target JOIN path USING (task_id, robot_id),
          (SELECT * FROM attempt WHERE status = 1 LIMIT 1) AS a
        WHERE NOT EXISTS (SELECT FROM attempt AS known WHERE known.report_uuid = path.report_uuid);
    UPDATE experience SET paths = counted.paths, attempts = counted.paths, generation = counted.paths
      FROM (SELECT task_id, robot_id, count(*) AS paths FROM target JOIN path
              USING (task_id, robot_id) GROUP BY 1, 2) AS counted
      WHERE experience.task_id = counted.task_id AND experience.robot_id = counted.robot_id)";
  return sql.str();
}

/// A database with its store open.
class Database {
 public:
  Database(const test::PostgresCluster& cluster, const std::string& name)
      : cluster_(&cluster),
        name_(name),
        store_(store::open_postgres_store(cluster.create_database(name))) {}

  store::Store& store() const { return *store_; }
  std::string query(const std::string& sql) const { return cluster_->query(sql, name_); }
  double number(const std::string& sql) const { return std::stod(query(sql)); }

 private:
  const test::PostgresCluster* cluster_;
  std::string name_;
  std::unique_ptr<store::Store> store_;
};

void fill(const Database& database, const Fleet& fleet, const FillPlan& plan) {
  constexpr std::uint64_t kPairsAtOnce = 20;
  fleet.fill(database.store(), 1, [](std::uint64_t) {});
  for (std::uint64_t pair = 1; pair < plan.pairs; ++pair)
    static_cast<void>(test::report(database.store(), {fleet.attempt(pair, 0)}));
  const double start_s = wall_s();
  for (std::uint64_t pair = 0; pair < plan.pairs - 1; pair += kPairsAtOnce) {
    database.query(copies_sql(pair, kPairsAtOnce));
    std::cerr << std::min(pair + kPairsAtOnce, plan.pairs - 1) << " of " << plan.pairs - 1
              << " pairs, " << wall_s() - start_s << " s\n";
  }
}

void measure_vacuum(const Database& database) {
  const double start_s = wall_s();
  database.query("VACUUM (ANALYZE)");
  print({.name = "vacuum and analyze of all, the first time",
         .value = wall_s() - start_s,
         .unit = "s"});
  const double again_s = wall_s();
  database.query("VACUUM (ANALYZE)");
  print({.name = "again, nothing to do", .value = wall_s() - again_s, .unit = "s"});
}

/// What is stored of a path without its waypoints, by relation, and the waypoints of the first
/// pair.
void measure_sizes(const Database& database, const Database& alone, const FillPlan& plan) {
  const double millions = database.number("SELECT count(*) FROM path") / kMillion;
  const auto per_million = [&](const std::string& name, const std::string& bytes) {
    print({.name = "a million paths: " + name,
           .value = database.number("SELECT " + bytes) / kMB / millions,
           .unit = "MB"});
  };
  per_million("rows of paths, without waypoints", "pg_relation_size('path') - 16 * " +
                                                      std::to_string(plan.dof) +
                                                      " * (SELECT count(*) FROM path)");
  per_million("rows of attempts", "pg_relation_size('attempt')");
  std::istringstream indexes(
      database.query("SELECT indexrelname FROM pg_stat_user_indexes WHERE relname IN "
                     "('path', 'attempt') AND pg_relation_size(indexrelid) > 1000000 ORDER BY 1"));
  for (std::string index; std::getline(indexes, index);)
    per_million("index " + index, "pg_relation_size('" + index + "')");
  print({.name = "a million paths with their waypoints, " + std::to_string(plan.waypoints) +
                 " of " + std::to_string(plan.dof) + " joints: everything",
         .value = alone.number("SELECT (pg_total_relation_size('path') + "
                               "pg_total_relation_size('attempt')) / (SELECT count(*) FROM path)"),
         .unit = "MB",
         .note = "random walks, which compress hardly"});
  print({.name = "the whole database",
         .value = database.number("SELECT pg_database_size(current_database())") / kMB,
         .unit = "MB",
         .note = std::to_string(millions) + " million paths"});
}

/// Reports to the first pair, one batch at a time, to both in turn.
void measure_reports(const Database& large, const Database& alone, const Fleet& fleet) {
  constexpr std::uint64_t kRounds = 150, kBatch = 16;
  std::vector<double> of_large, of_alone;
  const auto report = [&](const Database& database, std::uint64_t round) {
    std::vector<Attempt> attempts;
    for (std::uint64_t i = 0; i < kBatch; ++i)
      attempts.push_back(fleet.attempt(0, kFirstLater + round * kBatch + i));
    return least_s(1, wall_s,
                   [&] { static_cast<void>(test::report(database.store(), std::move(attempts))); });
  };
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    of_large.push_back(report(large, round));
    of_alone.push_back(report(alone, round));
  }
  for (const auto& [name, share] : {std::pair("p50", 0.5), std::pair("p99", 0.99)})
    print({.name = "receipts of a batch of 16, " + std::string(name),
           .value = 1e3 * percentile(of_large, share),
           .unit = "ms",
           .reference = Reference{"the pair alone", 1e3 * percentile(of_alone, share)}});
}

void run(const FillPlan& plan) {
  const test::PostgresCluster cluster(
      {.settings = {"fsync = on", "max_wal_size = 8GB", "checkpoint_timeout = 30min",
                    "shared_buffers = 1GB", "maintenance_work_mem = 512MB", "wal_level = minimal",
                    "max_wal_senders = 0"},
       .root = test::disk_root()});
  const Fleet fleet(plan);
  const Database alone(cluster, "alone"), large(cluster, "large");
  fleet.fill(alone.store(), 1, [](std::uint64_t) {});
  alone.query("VACUUM (ANALYZE)");
  fill(large, fleet, plan);
  measure_vacuum(large);
  measure_sizes(large, alone, plan);
  measure_questions(questions(fleet, plan), large.store(), alone.store());
  measure_reports(large, alone, fleet);
}

}  // namespace
}  // namespace kinship::bench

int main(int count, char** arguments) {
  const auto plan = kinship::bench::plan_from(count, arguments);
  if (!plan)
    return 2;
  if (const std::string missing = kinship::test::missing_postgres(); !missing.empty()) {
    std::cerr << "large_postgres_bench: " << missing << '\n';
    return 1;
  }
  kinship::bench::run(*plan);
}
