#include "server/store/sqlite/upkeep/store_check.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/rows/damage_search.hpp"
#include "server/store/tables/robots.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kMaxMessages = 100;
constexpr double kStructureShare = 0.4;  // of the time
constexpr double kRowsShare = 0.5;

/// A rule that rows must not break, as a query for the words about each row that does.
struct Rule {
  std::string table;
  std::string query;
};

const std::string kPair = "'task ' || task_id || ', robot ' || robot_id || ': ' || ";

// The sums that an experience has of its attempts in one sampling mode.
Rule rule_of_sums(const std::string& mode, int code, const std::string& counted) {
  // Sums of doubles depend on their order in the last bits.
  const auto differs = [&](const std::string& sum) {
    return "abs(" + mode + sum + " - found" + sum + ") > 1e-9 * (1 + found" + sum + ")";
  };
  const auto of_measured = [](const std::string& sum, const std::string& value) {
    return ", total(iif(" + std::string(kIsMeasured) + ", " + value + ", 0)) AS found" + sum;
  };
  return {"experience",
          "SELECT " + kPair + "'the sums of its " + mode +
              " attempts are wrong' FROM experience LEFT JOIN (SELECT task_id AS t, robot_id AS r,"
              " count(*) AS found_attempts, sum(outcome = 1) AS found_solved,"
              " total(collision_checks) AS found_checks,"
              " total(1.0 * collision_checks * collision_checks) AS found_checks_squared,"
              " total(iif(outcome = 1, collision_checks, 0)) AS found_checks_of_solved" +
              of_measured("_measured", "1") +
              of_measured("_time_s", "processor_time_s * machine_speed") +
              of_measured("_hand_length_m", "hand_length_m") +
              of_measured("_clearance_m", "least_clearance_m") +
              " FROM attempt WHERE sampling_mode = " + std::to_string(code) + " AND " + counted +
              " GROUP BY task_id, robot_id) ON t = task_id AND r = robot_id "
              "WHERE " +
              mode + "_attempts <> coalesce(found_attempts, 0) OR " + differs("_solved") + " OR " +
              differs("_checks") + " OR " + differs("_checks_squared") + " OR " +
              differs("_checks_of_solved") + " OR " + differs("_measured") + " OR " +
              differs("_time_s") + " OR " + differs("_hand_length_m") + " OR " +
              differs("_clearance_m")};
}

std::string not_quarantined(const std::string& table) { return "NOT " + in_quarantine(table); }

/// Of paths beside their attempts, and of the sums over these.
void add_rules_of_attempts(std::vector<Rule>& rules, const std::string& counted) {
  const std::string path_kept = not_quarantined("path");
  const std::string attempt_kept = not_quarantined("attempt");
  rules.push_back({"path",
                   "SELECT 'path ' || path.id || ': arrived at another time than its attempt' "
                   "FROM path JOIN attempt ON attempt.path_id = path.id AND attempt.status = 1 "
                   "WHERE " +
                       path_kept + " AND " + attempt_kept +
                       " AND path.received_ms <> attempt.received_ms"});
  rules.push_back({"evicted_distribution",
                   "SELECT 'distribution ' || lower(hex(digest)) || ': evicted, but there' "
                   "FROM evicted_distribution JOIN distribution USING (digest) WHERE " +
                       not_quarantined("distribution")});
  rules.push_back({"path",
                   "SELECT 'path ' || path.id || ': has another scene than its attempt' "
                   "FROM path JOIN attempt ON attempt.path_id = path.id AND attempt.status = 1 "
                   "WHERE " +
                       path_kept + " AND " + attempt_kept +
                       " AND path.scene_id IS NOT attempt.scene_id"});
  for (const auto& [mode, code] : {std::pair("guided", 1), std::pair("control", 2)})
    rules.push_back(rule_of_sums(mode, code, counted));
}

/// Rules of making room: paths beyond a cap, distributions by their last use.
void add_rules_of_room(std::vector<Rule>& rules, const std::string& counted) {
  // Paths that came again after damage may have been counted twice.
  rules.push_back(
      {"experience",
       "SELECT " + kPair +
           "'says ' || dropped || ' dropped paths, has ' || found FROM (SELECT *, (SELECT count(*) "
           "FROM attempt WHERE attempt.task_id = experience.task_id "
           "AND attempt.robot_id = experience.robot_id AND status = 1 AND path_id IS NULL AND " +
           counted +
           ") + (SELECT count(*) FROM path WHERE path.task_id = experience.task_id "
           "AND path.robot_id = experience.robot_id AND retired_ms IS NOT NULL AND " +
           std::string(kIsDropped) + " AND " + not_quarantined("path") +
           ") AS found FROM experience) WHERE dropped < found"});
  rules.push_back(
      {"distribution",
       "SELECT 'distribution ' || id || ': nothing says when it was used' FROM distribution "
       "WHERE id NOT IN (SELECT id FROM distribution_use) AND " +
           not_quarantined("distribution")});
  rules.push_back({"distribution_use",
                   "SELECT 'distribution ' || id || ': used, but not there' FROM distribution_use "
                   "WHERE id NOT IN (SELECT id FROM distribution)"});
}

std::vector<Rule> make_rules() {
  const std::string path_kept = not_quarantined("path");
  const std::string attempt_kept = not_quarantined("attempt");
  const std::string in_use = path_kept + " AND retired_ms IS NULL";
  // An attempt that came again stands there twice.
  const std::string counted =
      "NOT EXISTS (SELECT 1 FROM quarantine WHERE of_table = 'attempt' AND quarantine.id = "
      "attempt.id"
      " AND replaced_by IS NOT NULL)";
  // A repair may have left it without.
  const std::string lost_its_attempt = "path.id IN (SELECT id FROM lost_attempt)";
  std::vector<Rule> rules = {
      {"path",
       "SELECT 'path ' || path.id || ': ' || iif(attempt.id IS NULL, 'no attempt has its UUID',"
       " 'its attempt does not name it') FROM path "
       "LEFT JOIN attempt ON attempt.report_uuid = path.report_uuid AND " +
           counted + " WHERE " + path_kept +
           " AND (attempt.id IS NULL OR attempt.path_id IS NOT path.id) AND " + attempt_kept +
           " AND NOT " + lost_its_attempt},
      {"attempt",
       "SELECT 'attempt ' || attempt.id || ': its path is missing' FROM attempt "
       "LEFT JOIN path ON path.id = attempt.path_id WHERE status <> 3 AND path.id IS NULL "
       // It was beyond the cap.
       "AND NOT (status = 1 AND path_id IS NULL) AND " +
           attempt_kept},
      {"attempt",
       "SELECT 'attempt ' || attempt.id || ': its path is of another robot or task' FROM attempt "
       "JOIN path ON path.id = attempt.path_id WHERE " +
           attempt_kept + " AND " + path_kept +
           " AND (path.task_id, path.robot_id) <> (attempt.task_id, attempt.robot_id)"},
      {"experience",
       "SELECT " + kPair +
           "'says ' || paths || ' paths, has ' || found FROM (SELECT *, (SELECT count(*) FROM path "
           "WHERE path.task_id = experience.task_id AND path.robot_id = experience.robot_id AND " +
           in_use + ") AS found FROM experience) WHERE paths <> found"},
      {"experience",
       "SELECT " + kPair +
           "'says ' || attempts || ' attempts, has ' || found FROM (SELECT *, (SELECT count(*) "
           "FROM attempt WHERE attempt.task_id = experience.task_id "
           "AND attempt.robot_id = experience.robot_id AND " +
           counted + ") AS found FROM experience) WHERE attempts <> found"}};
  add_rules_of_attempts(rules, counted);
  add_rules_of_room(rules, counted);
  return rules;
}

class Checker {
 public:
  Checker(Database& database, const std::function<void(double)>& progress)
      : database_(&database), progress_(&progress) {}

  StoreCheck run(const std::filesystem::path& file);

 private:
  void note(const std::string& table, const std::string& message);
  /// A part that SQLite cannot read is one problem of the table; the rest is still checked.
  template <typename Part>
  void guarded(const std::string& table, Part part);
  void count_tables();
  void check_structure();
  void check_rows(const std::string& table);
  void check_robots();
  void check_epoch();

  Database* database_;
  const std::function<void(double)>* progress_;
  StoreCheck check_;
  std::size_t damaged_robots_ = 0;  // named by their labels
};

StoreCheck Checker::run(const std::filesystem::path& file) {
  check_.file = file.string();
  std::int64_t schema = 0;
  try {
    schema = known_schema(*database_, file, embedded_migrations());
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    // Nothing can be asked for without it.
    note("", "the schema cannot be read, so that nothing else is checked: " +
                 std::string(error.what()) +
                 "; 'kinshipd repair' keeps what can be read, 'kinshipd restore' takes a backup");
    return std::move(check_);
  }
  if (schema == 0)
    throw Failure(ErrorCode::Storage, "store '" + file.string() + "': is empty");
  check_.schema_version = static_cast<std::uint32_t>(schema);
  count_tables();
  guarded("", [&] { check_structure(); });
  (*progress_)(kStructureShare);
  guarded("setting", [&] {
    check_epoch();
    check_.release = release_of(*database_);
  });
  guarded("robot", [&] { check_robots(); });
  const std::vector<StoreCheck::Table> tables = check_.tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    guarded(tables[i].name, [&] { check_rows(tables[i].name); });
    (*progress_)(kStructureShare +
                 kRowsShare * static_cast<double>(i + 1) / static_cast<double>(tables.size()));
  }
  for (const Rule& rule : make_rules())
    guarded(rule.table, [&] {
      Statement query(database_->connection(), rule.query);
      while (query.step())
        note(rule.table, std::string(query.column_text(0)));
    });
  (*progress_)(1);
  return std::move(check_);
}

void Checker::note(const std::string& table, const std::string& message) {
  ++check_.problems;
  const auto found = std::ranges::find(check_.tables, table, &StoreCheck::Table::name);
  if (found != check_.tables.end())
    ++found->problems;
  if (check_.messages.size() < kMaxMessages)
    check_.messages.push_back((table.empty() ? "" : table + ": ") + message);
}

template <typename Part>
void Checker::guarded(const std::string& table, Part part) {
  try {
    part();
  } catch (const SqliteError& error) {
    note(table, error.what());
  }
}

void Checker::count_tables() {
  for (const std::string& name : tables_of(*database_)) {
    check_.tables.push_back({name, 0, 0});
    guarded(name, [&] {
      check_.tables.back().rows =
          static_cast<std::uint64_t>(database_->integer("SELECT count(*) FROM \"" + name + "\""));
    });
  }
  guarded("path", [&] {
    check_.damaged_paths = static_cast<std::uint64_t>(
        database_->integer("SELECT count(*) FROM quarantine WHERE of_table = 'path'"));
    check_.retired_paths = static_cast<std::uint64_t>(database_->integer(
        "SELECT count(*) FROM path WHERE retired_ms IS NOT NULL AND " + not_quarantined("path")));
  });
  check_.bytes = static_cast<std::uint64_t>(database_->integer("PRAGMA page_count") *
                                            database_->integer("PRAGMA page_size"));
}

void Checker::check_structure() {
  for (const std::string& line : store::check_structure(*database_, ""))
    note("", line);
  Statement foreign(database_->connection(), "PRAGMA foreign_key_check");
  while (foreign.step()) {
    const std::string table(foreign.column_text(0));
    const std::string row =
        foreign.column_is_null(1) ? "a row" : "row " + std::to_string(foreign.column_integer(1));
    note(table, row + " names a " + std::string(foreign.column_text(2)) + " that is not there");
  }
}

void Checker::check_epoch() {
  Statement epoch(database_->connection(), "SELECT value FROM setting WHERE key = 'epoch'");
  const std::optional<Uuid> parsed =
      epoch.step() ? Uuid::parse(epoch.column_text(0)) : std::nullopt;
  if (parsed)
    check_.epoch = *parsed;
  else
    note("setting", "the store's epoch is missing or no UUID");
}

void Checker::check_robots() {
  const std::vector<std::string> damaged = select_robots(*database_).damaged;
  damaged_robots_ = damaged.size();
  for (const std::string& label : damaged)
    note("robot", "'" + label + "': its row is damaged (checksum)");
}

void Checker::check_rows(const std::string& table) {
  constexpr std::int64_t kRows = 1000;
  RowsChecked part;
  do {
    part = store::check_rows(*database_, table, part.last_id, kRows);
    for (const std::string& row : part.damaged)
      if (table != "robot" || damaged_robots_ == 0)  // they have their names
        note(table, row + ": damaged (checksum)");
  } while (!part.is_last);
}

}  // namespace

StoreCheck check_database(Database& database, const std::filesystem::path& file,
                          const std::function<void(double)>& progress) {
  return Checker(database, progress).run(file);
}

}  // namespace kinship::store
