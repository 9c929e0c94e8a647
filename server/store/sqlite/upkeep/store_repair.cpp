#include "server/store/sqlite/upkeep/store_repair.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/damage_search.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/quarantine_rows.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/sqlite/upkeep/repair_account.hpp"
#include "server/store/sqlite/upkeep/schema_recovery.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

/// Copied row by row, in this order; of the others only what they say of these.
constexpr std::array<std::string_view, 6> kCopiedById = {"task",  "scene", "robot",
                                                         "audit", "path",  "attempt"};
constexpr int kSqlError = 1;  // SQLITE_ERROR: no such table, no such index

using Pair = std::pair<std::int64_t, std::int64_t>;  // task, robot

/// Adds a row of another store, checksum and all, unless it is there.
void insert_row(Database& target, const std::string& table, const Statement& row, int columns) {
  std::string places = "?";
  for (int column = 1; column < columns; ++column)
    places += ", ?";
  const auto insert = target.cached("INSERT OR IGNORE INTO " + table + " VALUES (" + places + ")");
  for (int column = 0; column < columns; ++column)
    insert->bind_column(column + 1, row, column);
  insert->run();
}

class Salvager {
 public:
  Salvager(Database& source, Database& target) : source_(&source), target_(&target) {}

  Salvaged run(const Progress& progress);

 private:
  /// Reads the source by SQL, as far as it goes: a damaged page ends it.
  template <typename Take>
  void for_each_of_source(const std::string& sql, Take take) const;
  bool try_step(const std::string& sql, std::optional<Statement>& query) const;
  /// Copies a small table row by row, as far as it goes.
  void copy_table(const std::string& name) const;
  /// Copies the rows that can be read, by their ids.
  void copy_by_id(const std::string& name);
  /// Copies rows from an id on. \return the first id that could not be read.
  std::optional<std::int64_t> copy_from(const std::string& name, std::int64_t first);
  std::optional<std::int64_t> next_readable(const std::string& name, std::int64_t id) const;
  std::optional<std::string> setting_of_source(const std::string& key) const;
  void keep_revision(Bytes digest, std::int64_t revision) const;
  void quarantine_bad_content() const;
  void add_placeholder_tasks() const;
  void add_placeholder_robots();
  void add_placeholder_scenes();
  void add_placeholder_paths();
  void make_experience() const;
  void count_lost(const std::string& table, const std::string& index);
  void lose(const std::string& table, const Pair& pair, std::uint64_t rows);
  std::string text_of(const std::string& sql, std::int64_t id) const;

  Database* source_;
  Database* target_;
  std::map<Pair, std::uint64_t> lost_paths_;
  Salvaged salvaged_;
};

template <typename Take>
void Salvager::for_each_of_source(const std::string& sql, Take take_row) const {
  std::optional<Statement> query;
  while (try_step(sql, query))
    take_row(*query);
}

/// Damage of any kind ends it; without its schema the source does not even know its tables.
bool Salvager::try_step(const std::string& sql, std::optional<Statement>& query) const try {
  if (!query)
    query.emplace(source_->connection(), sql);
  return query->step();
} catch (const SqliteError& error) {
  if (!error.is_damage() && error.sqlite_code() != kSqlError)
    throw;
  return false;
}

void Salvager::copy_table(const std::string& name) const {
  const bool is_checked = source_->checked_tables().contains(name);
  for_each_of_source(
      "SELECT * FROM " + name + (is_checked ? " WHERE " + source_->is_intact(name) : ""),
      [&](const Statement& row) { insert_row(*target_, name, row, row.columns()); });
}

void Salvager::copy_by_id(const std::string& name) {
  std::optional<std::int64_t> next = 0;
  while (next) {
    const std::optional<std::int64_t> unread = copy_from(name, *next);
    if (!unread)
      return;
    ++salvaged_.damaged_places;
    next = next_readable(name, *unread);
  }
}

std::optional<std::int64_t> Salvager::copy_from(const std::string& name, std::int64_t first) {
  std::int64_t next = first;
  const std::string sql = "SELECT *, " + source_->is_intact(name) + " FROM " + name +
                          " NOT INDEXED WHERE id >= " + std::to_string(first) + " ORDER BY id";
  Statement rows(source_->connection(), sql);
  while (true) {
    try {
      if (!rows.step())
        return std::nullopt;
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
      return next;
    }
    const int columns = rows.columns() - 1;
    if (rows.column_integer(columns) == 0) {
      ++salvaged_.damaged_places;
      continue;  // its id may be damaged, too
    }
    insert_row(*target_, name, rows, columns);
    next = std::max(next, rows.column_integer(0) + 1);
  }
}

/// The next id after one whose page cannot be read: by longer and longer steps, then back.
std::optional<std::int64_t> Salvager::next_readable(const std::string& name,
                                                    std::int64_t id) const {
  constexpr std::int64_t kLongestSearch = std::int64_t{1} << 40U;
  const auto from = [&](std::int64_t step) -> std::optional<std::int64_t> {
    std::optional<std::int64_t> found;
    if (id > std::numeric_limits<std::int64_t>::max() - step)
      return found;
    for_each_of_source("SELECT id FROM " + name + " NOT INDEXED WHERE id >= " +
                           std::to_string(id + step) + " ORDER BY id LIMIT 1",
                       [&](const Statement& row) { found = row.column_integer(0); });
    return found > id ? found : std::nullopt;
  };
  std::int64_t step = 1;
  while (step < kLongestSearch && !from(step))
    step *= 2;
  if (step >= kLongestSearch)
    return std::nullopt;
  std::int64_t too_short = step / 2;
  while (step - too_short > 1) {
    const std::int64_t middle = too_short + (step - too_short) / 2;
    (from(middle) ? step : too_short) = middle;
  }
  return from(step);
}

void Salvager::keep_revision(Bytes digest, std::int64_t revision) const {
  if (digest.size() != sizeof(Digest::bytes) || revision < 1)
    return;
  target_
      ->cached(
          "INSERT INTO evicted_distribution (digest, revision, evicted_ms) VALUES (?, ?, ?) ON "
          "CONFLICT (digest) DO UPDATE "
          "SET revision = max(revision, excluded.revision)")
      ->bind_all(digest, revision, now_ms())
      .run();
}

/// Rows that are as they were written, whose waypoints or bodies are not.
void Salvager::quarantine_bad_content() const {
  for (const char* const table : {"path", "scene"})
    for (const std::int64_t id :
         check_rows(*target_, table, 0, std::numeric_limits<std::int64_t>::max()).damaged_ids)
      quarantine_row(*target_, table, id);
}

std::string Salvager::text_of(const std::string& sql, std::int64_t id) const {
  Statement query(target_->connection(), sql);
  return query.bind(1, id).step() ? std::string(query.column_text(0)) : std::string();
}

void Salvager::lose(const std::string& table, const Pair& pair, std::uint64_t rows) {
  salvaged_.lost.push_back({table, text_of("SELECT label FROM robot WHERE id = ?", pair.second),
                            text_of("SELECT name FROM task WHERE id = ?", pair.first), rows});
}

void Salvager::add_placeholder_tasks() const {
  std::map<std::int64_t, std::string> names;
  for_each_of_source("SELECT id, name FROM task ORDER BY name", [&](const Statement& row) {
    names.emplace(row.column_integer(0), row.column_text(1));
  });
  Statement lost(target_->connection(),
                 "SELECT task_id FROM (SELECT task_id FROM path UNION SELECT task_id FROM attempt) "
                 "WHERE task_id NOT IN (SELECT id FROM task)");
  while (lost.step()) {
    const std::int64_t id = lost.column_integer(0);
    const auto name = names.find(id);
    const auto insert = [&](const std::string& as) {
      target_->cached("INSERT OR IGNORE INTO task (id, name) VALUES (?, ?)")
          ->bind_all(id, std::string_view(as))
          .run();
      return target_->changed_rows() > 0;
    };
    if (name == names.end() || !insert(name->second))  // another one may have it
      insert("lost-task-" + std::to_string(id));
  }
}

void Salvager::add_placeholder_robots() {
  std::map<std::int64_t, Digest> digests;
  std::map<std::int64_t, std::string> labels;
  for_each_of_source("SELECT id, digest FROM robot ORDER BY digest", [&](const Statement& row) {
    digests.emplace(row.column_integer(0), id_of<Digest>(row.column_blob(1)));
  });
  for_each_of_source("SELECT id, label FROM robot ORDER BY label", [&](const Statement& row) {
    labels.emplace(row.column_integer(0), row.column_text(1));
  });
  Statement lost(target_->connection(),
                 "SELECT robot_id, coalesce((SELECT dof FROM path AS p "
                 "WHERE p.robot_id = used.robot_id AND NOT EXISTS (SELECT 1 FROM quarantine "
                 "WHERE of_table = 'path' AND quarantine.id = p.id) LIMIT 1), 1) FROM "
                 "(SELECT robot_id FROM path UNION SELECT robot_id FROM attempt) AS used "
                 "WHERE robot_id NOT IN (SELECT id FROM robot)");
  while (lost.step()) {
    const std::int64_t id = lost.column_integer(0);
    std::string label = labels.contains(id) ? labels[id] : "lost-robot-" + std::to_string(id);
    const auto insert = [&](const Digest& digest) {
      target_
          ->cached(
              "INSERT OR IGNORE INTO robot (id, digest, label, dof, base_link, tip_link,"
              " T_tip_transfer, task_axes, registered_ms, crc32c, urdf)"
              " VALUES (?, iif(?, ?, randomblob(32)), ?, ?, '', '', zeroblob(56), 0, 0, 0, '')")
          ->bind_all(id, std::int64_t{digest == Digest() ? 0 : 1}, Bytes(digest.bytes),
                     std::string_view(label), lost.column_integer(1))
          .run();
      return target_->changed_rows() > 0;
    };
    if (!insert(digests[id])) {  // another one may have the digest or the label
      label = "lost-robot-" + std::to_string(id);
      insert(Digest());
    }
    salvaged_.lost.push_back({"robot", label, "", 1});
  }
}

void Salvager::add_placeholder_scenes() {
  std::map<std::int64_t, Digest> contents;
  for_each_of_source("SELECT id, content_sha256 FROM scene ORDER BY content_sha256",
                     [&](const Statement& row) {
                       contents.emplace(row.column_integer(0), id_of<Digest>(row.column_blob(1)));
                     });
  Statement lost(target_->connection(),
                 "SELECT scene_id FROM (SELECT scene_id FROM path UNION SELECT scene_id "
                 "FROM attempt) WHERE scene_id IS NOT NULL AND scene_id NOT IN "
                 "(SELECT id FROM scene)");
  std::uint64_t count = 0;
  while (lost.step()) {
    const std::int64_t id = lost.column_integer(0);
    const Digest content = contents.contains(id) ? contents[id] : Digest();
    target_
        ->cached(
            "INSERT INTO scene (id, content_sha256, received_ms, size, encoding, crc32c, scene)"
            " VALUES (?, ?, 0, 1, 1, 0, x'00')")
        ->bind_all(id, Bytes(content.bytes))
        .run();
    quarantine_row(*target_, "scene", id);
    ++count;
  }
  if (count > 0)
    salvaged_.lost.push_back({"scene", "", "", count});
}

void Salvager::add_placeholder_paths() {
  std::map<std::int64_t, Digest> contents;
  for_each_of_source(
      "SELECT id, content_sha256 FROM path INDEXED BY path_by_content WHERE retired_ms IS NULL",
      [&](const Statement& row) {
        contents.emplace(row.column_integer(0), id_of<Digest>(row.column_blob(1)));
      });
  std::set<std::int64_t> retired;
  for_each_of_source("SELECT id FROM path INDEXED BY path_retired WHERE retired_ms IS NOT NULL",
                     [&](const Statement& row) { retired.insert(row.column_integer(0)); });
  Statement lost(target_->connection(),
                 "SELECT path_id, task_id, robot_id, report_uuid, received_ms, scene_id "
                 "FROM attempt WHERE path_id IS NOT NULL AND path_id NOT IN "
                 "(SELECT id FROM path) ORDER BY status");
  while (lost.step()) {
    const std::int64_t id = lost.column_integer(0);
    const Pair pair(lost.column_integer(1), lost.column_integer(2));
    const Digest content = contents.contains(id) ? contents[id] : Digest();
    const auto insert = target_->cached(
        "INSERT OR IGNORE INTO path (id, task_id, robot_id, report_uuid, content_sha256,"
        " waypoint_count, dof, length, encoding, crc32c, waypoints, received_ms, retired_ms,"
        " scene_id) VALUES (?, ?, ?, ?, ?, 2, 1, 0, 2, 0, x'00', ?, iif(?, 1, NULL), ?)");
    insert->bind_all(id, pair.first, pair.second, lost.column_blob(3), Bytes(content.bytes),
                     lost.column_integer(4), std::int64_t{retired.contains(id) ? 1 : 0});
    insert->bind_column(8, lost, 5).run();
    if (target_->changed_rows() == 0 || find_quarantined(*target_, "path", id))
      continue;
    quarantine_row(*target_, "path", id);
    if (retired.contains(id))
      retire_quarantined(*target_, id);
    ++lost_paths_[pair];
  }
  for (const auto& [pair, rows] : lost_paths_)
    lose("path", pair, rows);
}

/// Counts the rows that an index of the source names and that were not found.
void Salvager::count_lost(const std::string& table, const std::string& index) {
  std::map<Pair, std::uint64_t> lost;
  const bool paths = table == "path";
  for_each_of_source(
      "SELECT task_id, robot_id, id FROM " + table + " INDEXED BY " + index +
          (paths ? " WHERE retired_ms IS NULL" : " WHERE NOT " + in_quarantine("attempt")),
      [&](const Statement& row) {
        const auto found = target_->cached("SELECT 1 FROM " + table + " WHERE id = ?");
        if (!found->bind(1, row.column_integer(2)).step())
          ++lost[{row.column_integer(0), row.column_integer(1)}];
      });
  for (const auto& [pair, rows] : lost)
    lose(table, pair, rows);
}

/// The sums of the attempts in a sampling mode.
void sum_up(Database& target, const std::string& name, int code) {
  const std::string measured(kIsMeasured);
  const auto sum = [&](const std::string& column, const std::string& value) {
    return ", total(iif(" + measured + ", " + value + ", 0)) AS " + column;
  };
  // A path that is lost counts with the mean length of the others.
  target.execute(
      "UPDATE experience SET " + name + "_attempts = n, " + name + "_solved = solved, " + name +
      "_checks = checks, " + name + "_checks_squared = squared, " + name +
      "_checks_of_solved = of_solved, " + name + "_measured = measured, " + name +
      "_time_s = time_s, " + name + "_length = length_of_measured, " + name +
      "_hand_length_m = hand_m, " + name +
      "_clearance_m = clearance_m FROM (SELECT attempt.task_id AS t, attempt.robot_id AS r,"
      " count(*) AS n, sum(outcome = 1) AS solved, total(collision_checks) AS checks,"
      " total(1.0 * collision_checks * collision_checks) AS squared,"
      " total(iif(outcome = 1, collision_checks, 0)) AS of_solved, sum(" +
      measured + ") AS measured, sum(" + measured + ") * coalesce(avg(iif(" + measured +
      ", length, NULL)), 0.0) AS length_of_measured" +
      sum("time_s", "processor_time_s * machine_speed") + sum("hand_m", "hand_length_m") +
      sum("clearance_m", "least_clearance_m") +
      " FROM attempt LEFT JOIN path ON path.id = attempt.path_id WHERE sampling_mode = " +
      std::to_string(code) +
      " GROUP BY attempt.task_id, attempt.robot_id) WHERE t = task_id AND r = robot_id");
}

void Salvager::make_experience() const {
  target_->execute(
      "INSERT OR IGNORE INTO experience (task_id, robot_id) "
      "SELECT task_id, robot_id FROM path UNION SELECT task_id, robot_id FROM attempt");
  // Nothing fitted before may pass for fresh, and nothing retired for present.
  for_each_of_source(
      "SELECT task_id, robot_id, generation, retired_generation FROM experience"
      " WHERE " +
          source_->is_intact("experience"),
      [&](const Statement& row) {
        target_
            ->cached(
                "UPDATE experience SET generation = ?, retired_generation = ? "
                "WHERE task_id = ? AND robot_id = ?")
            ->bind_all(row.column_integer(2), row.column_integer(3), row.column_integer(0),
                       row.column_integer(1))
            .run();
      });
  for_each_of_source(
      "SELECT task_id, robot_id, dropped FROM experience WHERE " + source_->is_intact("experience"),
      [&](const Statement& row) {
        target_->cached("UPDATE experience SET dropped = ? WHERE task_id = ? AND robot_id = ?")
            ->bind_all(row.column_integer(2), row.column_integer(0), row.column_integer(1))
            .run();
      });
  target_->execute(
      "UPDATE experience SET dropped = max(dropped, (SELECT count(*) FROM attempt "
      "WHERE attempt.task_id = experience.task_id AND attempt.robot_id = experience.robot_id"
      " AND status = 1 AND path_id IS NULL) + (SELECT count(*) FROM path "
      "WHERE path.task_id = experience.task_id AND path.robot_id = experience.robot_id"
      " AND retired_ms IS NOT NULL AND " +
      std::string(kIsDropped) + " AND NOT " + in_quarantine("path") + "))");
  target_->execute(
      "UPDATE experience SET generation = 1 + max(generation, (SELECT count(*) FROM path "
      "WHERE path.task_id = experience.task_id AND path.robot_id = experience.robot_id)),"
      " paths = (SELECT count(*) FROM path WHERE path.task_id = experience.task_id"
      " AND path.robot_id = experience.robot_id AND retired_ms IS NULL AND NOT " +
      in_quarantine("path") +
      "),"
      " attempts = (SELECT count(*) FROM attempt WHERE attempt.task_id = experience.task_id"
      " AND attempt.robot_id = experience.robot_id)");
  // A removed task is listed again with the next attempt, also if some of those before it are lost.
  target_->execute(
      "UPDATE task SET removed_attempts = min(removed_attempts, (SELECT coalesce(sum(attempts), 0)"
      " FROM experience WHERE experience.task_id = task.id)) WHERE removed_attempts IS NOT NULL");
  sum_up(*target_, "guided", 1);
  sum_up(*target_, "control", 2);
}

/// Empty if there is none or its row is damaged.
std::optional<std::string> Salvager::setting_of_source(const std::string& key) const {
  std::optional<std::string> value;
  for_each_of_source(
      "SELECT value FROM setting WHERE key = '" + key + "' AND " + source_->is_intact("setting"),
      [&](const Statement& row) { value = row.column_text(0); });
  return value;
}

Salvaged Salvager::run(const Progress& progress) {
  target_->execute("PRAGMA foreign_keys = OFF");
  Transaction transaction(*target_, Transaction::Kind::Write);
  for (std::size_t i = 0; i < kCopiedById.size(); ++i) {
    copy_by_id(std::string(kCopiedById[i]));
    progress(static_cast<double>(i + 1) / static_cast<double>(kCopiedById.size()));
  }
  salvaged_.tables = account_of_rows(*source_, *target_);
  // An attempt that came again stands there twice; the new row is enough.
  for_each_of_source(
      "SELECT id FROM quarantine WHERE of_table = 'attempt' AND " +
          source_->is_intact("quarantine"),
      [&](const Statement& row) {
        target_->cached("DELETE FROM attempt WHERE id = ?")->bind(1, row.column_integer(0)).run();
      });
  for_each_of_source(
      "SELECT of_table, id, replaced_by, retired_ms IS NOT NULL FROM quarantine"
      " WHERE of_table IN ('path', 'scene') AND " +
          source_->is_intact("quarantine"),
      [&](const Statement& row) {
        std::optional<std::int64_t> by;
        if (!row.column_is_null(2))
          by = row.column_integer(2);
        quarantine_row(*target_, row.column_text(0), row.column_integer(1), by);
        if (row.column_integer(3) != 0)
          retire_quarantined(*target_, row.column_integer(1));
      });
  quarantine_bad_content();
  add_placeholder_tasks();
  add_placeholder_robots();
  for (const char* const small : {"robot_held_joint", "robot_never_colliding", "robot_geometry",
                                  "retired_report", "same_content", "search", "mesh"})
    copy_table(small);
  add_placeholder_paths();
  add_placeholder_scenes();
  count_lost("path", "path_by_task_robot");
  count_lost("attempt", "attempt_by_task_robot");
  note_lost_attempts(*target_);
  make_experience();
  if (const auto floor = setting_of_source("revision_floor"))
    target_->cached("INSERT OR REPLACE INTO setting (key, value) VALUES ('revision_floor', ?)")
        ->bind(1, *floor)
        .run();
  salvaged_.epoch = Uuid::parse(setting_of_source("epoch").value_or("")).value_or(Uuid{});
  for_each_of_source(
      "SELECT digest, revision FROM evicted_distribution UNION ALL"
      " SELECT digest, revision FROM distribution ORDER BY digest",
      [&](const Statement& row) { keep_revision(row.column_blob(0), row.column_integer(1)); });
  transaction.commit();
  target_->execute("PRAGMA foreign_keys = ON");
  return std::move(salvaged_);
}

/// Rows as they were written, of the tables that are copied by ids and can be read to their ends.
std::int64_t count_intact(Database& store) {
  std::int64_t rows = 0;
  for (const std::string_view table : kCopiedById)
    rows += store.unless_damaged([&] {
      return store.integer("SELECT count(*) FROM " + std::string(table) + " NOT INDEXED WHERE " +
                           store.is_intact(table));
    });
  return rows;
}

}  // namespace

Salvaged salvage(const std::filesystem::path& file, Database& target,
                 const std::filesystem::path& target_file, const Progress& progress) {
  Database source(file, Access::ReadOnly);
  const SchemaState state = state_of_schema(source, file, target, target_file);
  if (state == SchemaState::Same)
    return Salvager(source, target).run(progress);
  const SchemaCopy copy(file, target, target_file);
  const bool is_mended =
      state == SchemaState::Damaged || count_intact(copy.database()) > count_intact(source);
  Salvaged salvaged = Salvager(is_mended ? copy.database() : source, target).run(progress);
  salvaged.damaged_places += is_mended ? 1U : 0U;
  return salvaged;
}

}  // namespace kinship::store
