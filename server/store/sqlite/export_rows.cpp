#include "server/store/sqlite/export_rows.hpp"

#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include "server/store/sqlite/attempt_rows.hpp"
#include "server/store/sqlite/experience_rows.hpp"
#include "server/store/sqlite/path_rows.hpp"
#include "server/store/sqlite/row_values.hpp"
#include "server/store/sqlite/scene_rows.hpp"

namespace kinship::store {
namespace {

struct Candidate {
  std::int64_t id = 0;
  Uuid report_uuid;
  std::optional<std::int64_t> path_id;
};

std::int64_t parse_cursor(std::string_view cursor) {
  std::int64_t id = 0;
  const auto [end, error] = std::from_chars(cursor.data(), cursor.data() + cursor.size(), id);
  if (!cursor.empty() && (error != std::errc() || end != cursor.data() + cursor.size() || id < 0))
    throw Failure(ErrorCode::InvalidInput,
                  "cursor '" + std::string(cursor) + "' is not one of this listing");
  return id;
}

/// \param query  of id, report_uuid, path_id.
void append(Statement& query, std::vector<Candidate>& candidates) {
  while (query.step()) {
    Candidate& candidate = candidates.emplace_back();
    candidate.id = query.column_integer(0);
    candidate.report_uuid = id_of<Uuid>(query.column_blob(1));
    if (!query.column_is_null(2))
      candidate.path_id = query.column_integer(2);
  }
}

/// The next attempts by id. With filters each robot and task brings its own next ones, read from
/// an index; the oldest of them all are the next of all.
std::vector<Candidate> next_candidates(Database& database, const std::vector<ExperienceKey>& keys,
                                       bool filtered, std::int64_t after_id, std::int64_t count) {
  std::vector<Candidate> candidates;
  if (!filtered) {
    const auto query = database.cached(
        "SELECT id, report_uuid, path_id FROM attempt WHERE id > ? ORDER BY id LIMIT ?");
    query->bind_all(after_id, count);
    append(*query, candidates);
    return candidates;
  }
  for (const ExperienceKey& key : keys) {
    const auto query = database.cached(
        "SELECT id, report_uuid, path_id FROM attempt INDEXED BY attempt_by_task_robot "
        "WHERE task_id = ? AND robot_id = ? AND id > ? ORDER BY id LIMIT ?");
    query->bind_all(key.task_id, key.robot_id, after_id, count);
    append(*query, candidates);
  }
  std::ranges::sort(candidates, {}, &Candidate::id);
  if (std::ssize(candidates) > count)
    candidates.resize(static_cast<std::size_t>(count));
  return candidates;
}

bool is_retired(Database& database, std::int64_t path_id) {
  const auto query = database.cached("SELECT retired_ms IS NOT NULL FROM path WHERE id = ?");
  return query->bind(1, path_id).step() && query->column_integer(0) != 0;
}

/// Nothing if its path is retired or damaged; a path or scene found damaged now is noted.
std::optional<Attempt> read_candidate(Database& database, const Candidate& candidate,
                                      ExportRead& noted) {
  if (candidate.path_id && is_retired(database, *candidate.path_id))
    return std::nullopt;
  std::optional<AttemptRow> row = select_attempt(database, candidate.report_uuid);
  if (!row)
    return std::nullopt;
  if (candidate.path_id) {
    PathsRead read = select_path(database, *candidate.path_id);
    noted.damaged.insert(noted.damaged.end(), read.damaged.begin(), read.damaged.end());
    if (!read.paths.empty())
      row->attempt.path = std::move(read.paths.front().path);
  }
  if (row->attempt.path.has_value() != (row->attempt.record.outcome == Outcome::Solved))
    return std::nullopt;
  if (row->scene_id) {
    SceneRead read = select_scene(database, *row->scene_id);
    if (read.damaged)
      noted.damaged_scenes.push_back(*row->scene_id);
    row->attempt.scene = std::move(read.scene);
  }
  return std::move(row->attempt);
}

}  // namespace

ExportRead export_page(Database& database, const std::optional<Digest>& robot,
                       std::string_view task, std::string_view cursor, std::size_t limit,
                       std::size_t max_bytes) {
  constexpr std::int64_t kCandidates = 64;
  const std::size_t rows = std::max<std::size_t>(limit, 1);
  const bool filtered = robot || !task.empty();
  const std::vector<ExperienceKey> keys =
      filtered ? select_experience(database, robot, task) : std::vector<ExperienceKey>();
  ExportRead read;
  std::int64_t last_id = parse_cursor(cursor);
  std::size_t bytes = 0;
  while (true) {
    const auto candidates = next_candidates(database, keys, filtered, last_id, kCandidates);
    if (candidates.empty())
      return read;
    for (const Candidate& candidate : candidates) {
      if (std::optional<Attempt> attempt = read_candidate(database, candidate, read)) {
        const BatchBytes more = batch_bytes(*attempt);
        bytes += more.waypoints + more.scenes;
        if (read.page.rows.size() == rows || (!read.page.rows.empty() && bytes > max_bytes)) {
          read.page.next_cursor = std::to_string(last_id);
          return read;
        }
        read.page.rows.push_back(std::move(*attempt));
      }
      last_id = candidate.id;
    }
  }
}

}  // namespace kinship::store
