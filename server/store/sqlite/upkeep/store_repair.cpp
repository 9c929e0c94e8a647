#include "server/store/sqlite/upkeep/store_repair.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "server/store/sqlite/database/checked_vfs.hpp"
#include "server/store/sqlite/database/page_seal.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/path_rows.hpp"
#include "server/store/sqlite/rows/scene_rows.hpp"
#include "server/store/sqlite/rows/set_aside_rows.hpp"
#include "server/store/sqlite/upkeep/row_salvage.hpp"
#include "server/store/values/clock.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

void bind_raw(Statement& statement, int index, const RawValue& value) {
  if (const auto* const integer = std::get_if<std::int64_t>(&value))
    statement.bind(index, *integer);
  else if (const auto* const real = std::get_if<double>(&value))
    statement.bind(index, *real);
  else if (const auto* const text = std::get_if<std::string>(&value))
    statement.bind(index, std::string_view(*text));
  else if (const auto* const blob = std::get_if<std::vector<std::uint8_t>>(&value))
    statement.bind(index, Bytes(*blob));
  else
    statement.bind(index, std::nullopt);
}

/// The table of a row tells itself by the number of its columns, of which no two have the same.
struct TableShape {
  std::string_view name;
  std::size_t columns;
};
constexpr std::array<TableShape, 6> kShapes = {
    {{"task", 2}, {"scene", 7}, {"robot", 11}, {"audit", 12}, {"path", 16}, {"attempt", 22}}};
constexpr int kSqlError = 1;  // SQLITE_ERROR: no such table, no such index
constexpr std::size_t kDistributionColumns = 14, kDistributionDigest = 1, kDistributionRevision = 2;

using Pair = std::pair<std::int64_t, std::int64_t>;  // task, robot

class Salvager {
 public:
  Salvager(Database& source, Database& target) : source_(&source), target_(&target) {}

  Salvaged run(PageReader& reader, const Progress& progress);

 private:
  /// Reads the source by SQL, as far as it goes: a damaged page ends it.
  template <typename Take>
  void for_each_of_source(const std::string& sql, Take take) const;
  /// Copies a small table row by row, as far as it goes.
  void copy_table(const std::string& name, int columns) const;
  void take(const RawRow& row);
  void insert(const TableShape& shape, const RawRow& row) const;
  void keep_revision(Bytes digest, std::int64_t revision) const;
  void set_bad_content_aside() const;
  void name_lost_tasks() const;
  void name_lost_robots();
  void stand_in_for_lost_scenes();
  void stand_in_for_lost_paths();
  void note_orphans() const;
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
  try {
    Statement query(source_->connection(), sql);
    while (query.step())
      take_row(query);
  } catch (const SqliteError& error) {
    // Damage of any kind; without its schema the source does not even know its tables.
    if (!error.is_damage() && error.sqlite_code() != kSqlError)
      throw;
  }
}

void Salvager::copy_table(const std::string& name, int columns) const {
  std::string marks = "?";
  for (int column = 1; column < columns; ++column)
    marks += ", ?";
  for_each_of_source("SELECT * FROM " + name, [&](const Statement& row) {
    const auto insert =
        target_->cached("INSERT OR IGNORE INTO " + name + " VALUES (" + marks + ")");
    for (int column = 0; column < columns; ++column)
      insert->bind_column(column + 1, row, column);
    insert->run();
  });
}

void Salvager::insert(const TableShape& shape, const RawRow& row) const {
  std::string sql = "INSERT OR IGNORE INTO " + std::string(shape.name) + " VALUES (?";
  for (std::size_t column = 1; column < shape.columns; ++column)
    sql += ", ?";
  const auto statement = target_->cached(sql + ")");
  statement->bind(1, row.id);
  for (std::size_t column = 1; column < row.values.size(); ++column)
    bind_raw(*statement, static_cast<int>(column) + 1, row.values[column]);
  try {
    statement->run();
  } catch (const SqliteError& error) {
    if (!error.concerns_one_row())
      throw;  // a row of another kind has values that do not fit
  }
}

void Salvager::keep_revision(Bytes digest, std::int64_t revision) const {
  if (digest.size() != sizeof(Digest::bytes) || revision < 1)
    return;
  target_
      ->cached(
          "INSERT INTO evicted_distribution VALUES (?, ?, ?) ON CONFLICT (digest) DO UPDATE "
          "SET revision = max(revision, excluded.revision)")
      ->bind_all(digest, revision, now_ms())
      .run();
}

void Salvager::take(const RawRow& row) {
  const std::size_t columns = row.values.size();
  if (columns == kDistributionColumns) {
    const auto* const digest =
        std::get_if<std::vector<std::uint8_t>>(&row.values[kDistributionDigest]);
    const auto* const revision = std::get_if<std::int64_t>(&row.values[kDistributionRevision]);
    if (digest != nullptr && revision != nullptr)
      keep_revision(*digest, *revision);
    return;
  }
  for (const TableShape& shape : kShapes)
    if (columns == shape.columns)
      insert(shape, row);
}

/// Content that was damaged before its page was sealed.
void Salvager::set_bad_content_aside() const {
  constexpr std::int64_t kRows = 1000;
  for (PathsChecked page = check_paths(*target_, 0, kRows); page.paths > 0;
       page = check_paths(*target_, page.last_id, kRows))
    for (const std::int64_t id : page.damaged)
      put_aside(*target_, AsideKind::Path, id);
  for (ScenesChecked page = check_scenes(*target_, 0, kRows); page.scenes > 0;
       page = check_scenes(*target_, page.last_id, kRows))
    for (const std::int64_t id : page.damaged)
      put_aside(*target_, AsideKind::Scene, id);
}

std::string Salvager::text_of(const std::string& sql, std::int64_t id) const {
  Statement query(target_->connection(), sql);
  return query.bind(1, id).step() ? std::string(query.column_text(0)) : std::string();
}

void Salvager::lose(const std::string& table, const Pair& pair, std::uint64_t rows) {
  salvaged_.lost.push_back({table, text_of("SELECT label FROM robot WHERE id = ?", pair.second),
                            text_of("SELECT name FROM task WHERE id = ?", pair.first), rows});
}

void Salvager::name_lost_tasks() const {
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
    target_->cached("INSERT INTO task VALUES (?, ?)")
        ->bind(1, id)
        .bind(2, std::string_view(name != names.end() ? name->second
                                                      : "lost-task-" + std::to_string(id)))
        .run();
  }
}

void Salvager::name_lost_robots() {
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
                 "WHERE p.robot_id = used.robot_id AND NOT EXISTS (SELECT 1 FROM set_aside "
                 "WHERE kind = 1 AND set_aside.id = p.id) LIMIT 1), 1) FROM "
                 "(SELECT robot_id FROM path UNION SELECT robot_id FROM attempt) AS used "
                 "WHERE robot_id NOT IN (SELECT id FROM robot)");
  while (lost.step()) {
    const std::int64_t id = lost.column_integer(0);
    const std::string label = labels.contains(id) ? labels[id] : "lost-robot-" + std::to_string(id);
    const Bytes digest(digests[id].bytes);
    target_
        ->cached(
            "INSERT INTO robot VALUES (?, iif(?, ?, randomblob(32)), ?, ?, '', '', zeroblob(56),"
            " 0, 0, 0, '')")
        ->bind_all(id, std::int64_t{digests[id] == Digest() ? 0 : 1}, digest,
                   std::string_view(label), lost.column_integer(1))
        .run();
    salvaged_.lost.push_back({"robot", label, "", 1});
  }
}

void Salvager::stand_in_for_lost_scenes() {
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
    target_->cached("INSERT INTO scene VALUES (?, ?, 0, 1, 1, 0, x'00')")
        ->bind_all(id, Bytes(content.bytes))
        .run();
    put_aside(*target_, AsideKind::Scene, id);
    ++count;
  }
  if (count > 0)
    salvaged_.lost.push_back({"scene", "", "", count});
}

void Salvager::stand_in_for_lost_paths() {
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
        "INSERT OR IGNORE INTO path VALUES (?, ?, ?, ?, ?, 2, 1, 0, 0, NULL, 2, 0, x'00', ?,"
        " iif(?, 1, NULL), ?)");
    insert->bind_all(id, pair.first, pair.second, lost.column_blob(3), Bytes(content.bytes),
                     lost.column_integer(4), std::int64_t{retired.contains(id) ? 1 : 0});
    insert->bind_column(8, lost, 5).run();
    if (target_->changed_rows() == 0 || find_aside(*target_, AsideKind::Path, id))
      continue;
    put_aside(*target_, AsideKind::Path, id);
    if (retired.contains(id))
      retire_aside(*target_, id);
    ++lost_paths_[pair];
  }
  for (const auto& [pair, rows] : lost_paths_)
    lose("path", pair, rows);
}

/// Counts the rows that an index of the source names and that were not found.
void Salvager::count_lost(const std::string& table, const std::string& index) {
  std::map<Pair, std::uint64_t> lost;
  const bool paths = table == "path";
  for_each_of_source("SELECT task_id, robot_id, id FROM " + table + " INDEXED BY " + index +
                         (paths ? " WHERE retired_ms IS NULL" : ""),
                     [&](const Statement& row) {
                       const auto found =
                           target_->cached("SELECT 1 FROM " + table + " WHERE id = ?");
                       if (!found->bind(1, row.column_integer(2)).step())
                         ++lost[{row.column_integer(0), row.column_integer(1)}];
                     });
  for (const auto& [pair, rows] : lost)
    lose(table, pair, rows);
}

void Salvager::note_orphans() const {
  target_->execute(
      "INSERT OR IGNORE INTO set_aside SELECT 5, id, 1, NULL, NULL, 'lost in a repair' FROM path "
      "WHERE NOT EXISTS (SELECT 1 FROM set_aside AS aside WHERE kind = 1 AND aside.id = path.id) "
      "AND NOT EXISTS (SELECT 1 FROM attempt WHERE attempt.report_uuid = path.report_uuid "
      "AND attempt.path_id = path.id)");
}

void Salvager::make_experience() const {
  target_->execute(
      "INSERT OR IGNORE INTO experience (task_id, robot_id) "
      "SELECT task_id, robot_id FROM path UNION SELECT task_id, robot_id FROM attempt");
  // Nothing fitted before may pass for fresh, and nothing retired for present.
  for_each_of_source("SELECT task_id, robot_id, generation, retired_generation FROM experience",
                     [&](const Statement& row) {
                       target_
                           ->cached(
                               "UPDATE experience SET generation = ?, retired_generation = ? "
                               "WHERE task_id = ? AND robot_id = ?")
                           ->bind_all(row.column_integer(2), row.column_integer(3),
                                      row.column_integer(0), row.column_integer(1))
                           .run();
                     });
  for_each_of_source(
      "SELECT task_id, robot_id, dropped FROM experience", [&](const Statement& row) {
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
      std::string(kIsDropped) +
      " AND NOT EXISTS (SELECT 1 FROM set_aside WHERE kind = 1 AND set_aside.id = path.id)))");
  target_->execute(
      "UPDATE experience SET generation = 1 + max(generation, (SELECT count(*) FROM path "
      "WHERE path.task_id = experience.task_id AND path.robot_id = experience.robot_id)),"
      " paths = (SELECT count(*) FROM path WHERE path.task_id = experience.task_id"
      " AND path.robot_id = experience.robot_id AND retired_ms IS NULL AND NOT EXISTS"
      " (SELECT 1 FROM set_aside WHERE kind = 1 AND set_aside.id = path.id)),"
      " attempts = (SELECT count(*) FROM attempt WHERE attempt.task_id = experience.task_id"
      " AND attempt.robot_id = experience.robot_id)");
  for (const auto& [mode, code] : {std::pair("guided", 1), std::pair("control", 2)}) {
    const std::string name(mode);
    target_->execute(
        "UPDATE experience SET " + name + "_attempts = n, " + name + "_solved = solved, " + name +
        "_checks = checks, " + name + "_checks_squared = squared, " + name +
        "_checks_of_solved = of_solved FROM (SELECT task_id AS t, robot_id AS r, count(*) AS n,"
        " sum(outcome = 1) AS solved, total(collision_checks) AS checks,"
        " total(1.0 * collision_checks * collision_checks) AS squared,"
        " total(iif(outcome = 1, collision_checks, 0)) AS of_solved FROM attempt WHERE "
        "sampling_mode = " +
        std::to_string(code) + " GROUP BY task_id, robot_id) WHERE t = task_id AND r = robot_id");
  }
}

Salvaged Salvager::run(PageReader& reader, const Progress& progress) {
  target_->execute("PRAGMA foreign_keys = OFF");
  Transaction transaction(*target_, Transaction::Kind::Write);
  salvaged_.damaged_pages = for_each_row(
      reader, [this](const RawRow& row) { take(row); }, progress);
  // An attempt that came again stands there twice; the new row is enough.
  for_each_of_source("SELECT id FROM set_aside WHERE kind = 2", [&](const Statement& row) {
    target_->cached("DELETE FROM attempt WHERE id = ?")->bind(1, row.column_integer(0)).run();
  });
  for_each_of_source(
      "SELECT kind, id, replaced_by, retired_ms IS NOT NULL FROM set_aside WHERE kind IN (1, 3)",
      [&](const Statement& row) {
        const auto kind = static_cast<AsideKind>(row.column_integer(0));
        std::optional<std::int64_t> by;
        if (!row.column_is_null(2))
          by = row.column_integer(2);
        put_aside(*target_, kind, row.column_integer(1), by);
        if (row.column_integer(3) != 0)
          retire_aside(*target_, row.column_integer(1));
      });
  set_bad_content_aside();
  name_lost_tasks();
  name_lost_robots();
  copy_table("robot_held_joint", 3);
  copy_table("robot_never_colliding", 4);
  copy_table("robot_geometry", 4);
  copy_table("retired_report", 3);
  copy_table("same_content", 2);
  stand_in_for_lost_paths();
  stand_in_for_lost_scenes();
  count_lost("path", "path_by_task_robot");
  count_lost("attempt", "attempt_by_task_robot");
  note_orphans();
  make_experience();
  for_each_of_source(
      "SELECT value FROM setting WHERE key = 'revision_floor'", [&](const Statement& row) {
        target_->cached("INSERT OR REPLACE INTO setting VALUES ('revision_floor', ?)")
            ->bind(1, row.column_text(0))
            .run();
      });
  for_each_of_source(
      "SELECT digest, revision FROM evicted_distribution",
      [&](const Statement& row) { keep_revision(row.column_blob(0), row.column_integer(1)); });
  transaction.commit();
  target_->execute("PRAGMA foreign_keys = ON");
  return std::move(salvaged_);
}

/// The size of pages that the seals say, whatever the header does.
std::size_t sealed_page_size(Database& source) {
  constexpr std::array<std::size_t, 8> kSizes = {8192, 4096, 1024, 2048, 16384, 32768, 65536, 512};
  constexpr std::uint64_t kTried = 20;
  set_sealed(source.connection(), true);
  for (const std::size_t size : kSizes) {
    PageReader reader(source, size);
    const std::uint64_t last = std::min(reader.count(), kTried);
    for (std::uint64_t page = 2; page <= last; ++page)
      if (const auto bytes = reader.read(page); bytes && bears_seal(*bytes))
        return size;
  }
  throw Failure(ErrorCode::Storage,
                "its pages bear no checksums: it is no store; restore a backup");
}

}  // namespace

Salvaged salvage(Database& source, Database& target, const Progress& progress) {
  PageReader reader(source, sealed_page_size(source));
  return Salvager(source, target).run(reader, progress);
}

}  // namespace kinship::store
