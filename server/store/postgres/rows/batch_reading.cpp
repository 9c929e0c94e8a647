#include "server/store/postgres/rows/batch.hpp"

#include <algorithm>
#include <array>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/rows/retirement.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/path_content.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store::postgres {
namespace {

/// The distinct pairs of a batch, as columns.
struct WantedPairs {
  std::vector<std::string> new_tasks;  // of new reports; they are there already, or are made
  std::vector<std::string> tasks;
  std::vector<std::int64_t> robots;
  std::vector<std::int64_t> paths;  // that come
};

/// The distinct contents of a batch, as columns.
struct WantedContents {
  std::vector<std::string> tasks;
  std::vector<std::int64_t> robots;
  std::vector<Bytes> contents;
};

constexpr std::string_view kRobots =
    "SELECT digest, id, dof, label FROM robot WHERE digest = ANY($1) ORDER BY id FOR KEY SHARE";

constexpr std::string_view kBodies =
    "SELECT report_uuid, body_sha256, machine,"
    " (SELECT name FROM task WHERE task.id = attempt.task_id)"
    " FROM attempt WHERE report_uuid = ANY($1)";

constexpr std::string_view kMakeTasks =
    "INSERT INTO task (name) SELECT name FROM unnest($1) AS wanted (name)"
    " WHERE NOT EXISTS (SELECT 1 FROM task WHERE task.name = wanted.name)"
    " ORDER BY name COLLATE \"C\" ON CONFLICT (name) DO NOTHING";

// Until the commit no name of these changes.
constexpr std::string_view kLockTasks =
    "SELECT 1 FROM task WHERE name = ANY($1) ORDER BY name FOR KEY SHARE";

constexpr std::string_view kMakePairs =
    "INSERT INTO experience (task_id, robot_id) SELECT task.id, wanted.robot_id"
    " FROM unnest($1, $2) AS wanted (task, robot_id) JOIN task ON task.name = wanted.task"
    " WHERE NOT EXISTS (SELECT 1 FROM experience AS old"
    "  WHERE old.task_id = task.id AND old.robot_id = wanted.robot_id)"
    " ORDER BY task.id, wanted.robot_id ON CONFLICT (task_id, robot_id) DO NOTHING";

constexpr std::string_view kLockPairs =
    "SELECT robot.digest, task.name, experience.task_id, experience.robot_id, experience.paths"
    " FROM unnest($1, $2) AS wanted (task, robot_id) JOIN task ON task.name = wanted.task"
    " JOIN experience ON experience.task_id = task.id AND experience.robot_id = wanted.robot_id"
    " JOIN robot ON robot.id = experience.robot_id"
    " ORDER BY experience.task_id, experience.robot_id FOR NO KEY UPDATE OF experience";

constexpr std::string_view kReports =
    "SELECT attempt.report_uuid, body_sha256, machine, attempt.received_ms, path_id,"
    " scene.damaged_ms IS NOT NULL, (SELECT name FROM task WHERE task.id = attempt.task_id)"
    " FROM attempt LEFT JOIN scene ON scene.id = attempt.scene_id"
    " WHERE attempt.report_uuid = ANY($1)";

constexpr std::string_view kRetired =
    "SELECT report_uuid FROM retired_report WHERE report_uuid = ANY($1)";

constexpr std::string_view kScenes =
    "SELECT content_sha256, damaged_ms IS NULL FROM scene WHERE content_sha256 = ANY($1)";

constexpr std::string_view kPathIds =
    "SELECT nextval(pg_get_serial_sequence('path', 'id')) FROM generate_series(1, $1)";

// For pairs that may end with more than $4 paths, the paths with the largest digests: all that the
// batch can drop, and the next one, which is the threshold.
constexpr std::string_view kLargest =
    "SELECT robot.digest, task.name, kept.id, kept.content_sha256, kept.report_uuid,"
    " kept.T_task_base, kept.dof, kept.waypoint_count"
    " FROM unnest($1, $2, $3) AS wanted (task, robot_id, paths)"
    " JOIN task ON task.name = wanted.task JOIN robot ON robot.id = wanted.robot_id"
    " JOIN experience ON experience.task_id = task.id AND experience.robot_id = robot.id"
    " CROSS JOIN LATERAL (SELECT * FROM path WHERE path.robot_id = experience.robot_id"
    "  AND path.task_id = experience.task_id AND retired_ms IS NULL AND damaged_ms IS NULL"
    "  ORDER BY content_sha256 DESC LIMIT CASE WHEN experience.paths + wanted.paths <= $4 THEN 0"
    "   ELSE least(greatest(experience.paths - $4, 0) + wanted.paths, $5 * wanted.paths) + $5 + 1"
    "   END) AS kept WHERE wanted.paths > 0";

std::string paths_of_reports() {
  return "SELECT " + std::string(kPathContentColumns) +
         ", retired_ms IS NOT NULL, damaged_ms IS NOT NULL FROM path"
         " WHERE id IN (SELECT path_id FROM attempt WHERE report_uuid = ANY($1))";
}

/// One look at the index for each: joined, they would be all paths read once, in a plan made while
/// there were few.
std::string paths_of_contents() {
  return "SELECT same.*, robot.digest, wanted.task, wanted.content"
         " FROM unnest($1, $2, $3) AS wanted (task, robot_id, content)"
         " JOIN task ON task.name = wanted.task JOIN robot ON robot.id = wanted.robot_id"
         " CROSS JOIN LATERAL (SELECT " +
         std::string(kPathContentColumns) +
         " FROM path WHERE path.robot_id = wanted.robot_id AND path.task_id = task.id"
         "  AND path.content_sha256 = wanted.content AND retired_ms IS NULL"
         "  AND damaged_ms IS NULL LIMIT 1) AS same";
}

std::vector<Bytes> uuids_of(PreparedAttempts attempts) {
  std::vector<Bytes> uuids;
  for (const PreparedAttempt* const each : attempts)
    uuids.emplace_back(each->attempt.report_uuid.bytes);
  return uuids;
}

std::vector<Bytes> robots_of(PreparedAttempts attempts) {
  std::set<Digest> distinct;
  std::vector<Bytes> robots;
  for (const PreparedAttempt* const each : attempts)
    if (distinct.insert(each->attempt.robot).second)
      robots.emplace_back(each->attempt.robot.bytes);
  return robots;
}

std::vector<Bytes> scenes_of(PreparedAttempts attempts) {
  std::set<Digest> distinct;
  std::vector<Bytes> scenes;
  for (const PreparedAttempt* const each : attempts)
    if (each->scene && distinct.insert(each->scene->content).second)
      scenes.emplace_back(each->scene->content.bytes);
  return scenes;
}

WantedPairs pairs_of(PreparedAttempts attempts, const BatchState& state) {
  std::map<std::pair<std::string, std::int64_t>, std::int64_t> paths;
  std::set<std::string> new_tasks;
  for (const PreparedAttempt* const each : attempts) {
    paths[{pair_name(*each, state).second, state.robots.at(each->attempt.robot).id}] +=
        each->path ? 1 : 0;
    if (!state.reports.contains(each->attempt.report_uuid))
      new_tasks.insert(each->attempt.task);
  }
  WantedPairs pairs;
  pairs.new_tasks.assign(new_tasks.begin(), new_tasks.end());
  for (const auto& [pair, count] : paths) {
    pairs.tasks.push_back(pair.first);
    pairs.robots.push_back(pair.second);
    pairs.paths.push_back(count);
  }
  return pairs;
}

WantedContents contents_of(PreparedAttempts attempts, const BatchState& state) {
  std::set<std::pair<PairName, Digest>> distinct;
  WantedContents wanted;
  for (const PreparedAttempt* const each : attempts) {
    const PairName pair = pair_name(*each, state);
    if (!each->path || !distinct.insert({pair, each->path->content}).second)
      continue;
    wanted.tasks.push_back(pair.second);
    wanted.robots.push_back(state.robots.at(each->attempt.robot).id);
    wanted.contents.emplace_back(each->path->content.bytes);
  }
  return wanted;
}

/// Reads the rows that decide which pairs are locked.
void read_robots(Connection& connection, PreparedAttempts attempts, BatchState& state) {
  const std::array<Request, 3> requests = {Request{kBeforeReports},
                                           Request{kRobots, Parameters(robots_of(attempts))},
                                           Request{kBodies, Parameters(uuids_of(attempts))}};
  const std::vector<Rows> rows = connection.query_all(requests);
  for (const Row row : rows[1])
    if (!is_removed_label(row.column_text(3)))
      state.robots[id_of<Digest>(row.column_blob(0))] = {row.column_integer(1),
                                                         row.column_integer(2)};
  for (const Row row : rows[2])
    state.reports[id_of<Uuid>(row.column_blob(0))] = {.body = id_of<Digest>(row.column_blob(1)),
                                                      .machine = std::string(row.column_text(2)),
                                                      .task = std::string(row.column_text(3))};
}

void take_pairs(const Rows& rows, BatchState& state) {
  for (const Row row : rows)
    state.pairs[{id_of<Digest>(row.column_blob(0)), std::string(row.column_text(1))}] = {
        .key = {row.column_integer(2), row.column_integer(3)},
        .paths = count_of(row, 4),
        .contents = {},
        .largest = {}};
}

void take_reports(const Rows& rows, const Rows& paths, BatchState& state) {
  constexpr int kIsRetired = 8, kIsDamaged = 9;
  std::map<std::int64_t, bool> is_backed;
  for (const Row row : paths)
    is_backed[row.column_integer(0)] =
        row.column_integer(kIsRetired) != 0 ||
        (row.column_integer(kIsDamaged) == 0 && has_right_path_crc(row));
  state.reports.clear();
  for (const Row row : rows) {
    EarlierReport report{.body = id_of<Digest>(row.column_blob(1)),
                         .machine = std::string(row.column_text(2)),
                         .received_ms = row.column_integer(3),
                         .path_id = optional_integer_of(row, 4),
                         .is_scene_readable = row.column_integer(5) == 0,
                         .task = std::string(row.column_text(6))};
    if (report.path_id)
      report.is_path_backed = is_backed[*report.path_id];
    state.reports.emplace(id_of<Uuid>(row.column_blob(0)), std::move(report));
  }
}

[[noreturn]] void refuse_renamed(const PairName& pair) {
  constexpr const char* kSerializationFailure = "40001";
  throw PostgresError(kSerializationFailure, "task '" + pair.second + "' was renamed meanwhile");
}

Pair& require_pair(BatchState& state, const PairName& name) {
  const auto pair = state.pairs.find(name);
  if (pair == state.pairs.end())
    refuse_renamed(name);
  return pair->second;
}

void take_contents(const Rows& rows, BatchState& state) {
  constexpr int kRobot = 8, kTask = 9, kContent = 10;
  for (const Row row : rows) {
    Pair& pair = require_pair(
        state, {id_of<Digest>(row.column_blob(kRobot)), std::string(row.column_text(kTask))});
    SameContent& same = pair.contents[id_of<Digest>(row.column_blob(kContent))];
    if (has_right_path_crc(row))
      same.readable = row.column_integer(0);
    else
      same.damaged.push_back(row.column_integer(0));
  }
}

void take_largest(const Rows& rows, BatchState& state) {
  for (const Row row : rows)
    require_pair(state, {id_of<Digest>(row.column_blob(0)), std::string(row.column_text(1))})
        .largest.insert({id_of<Digest>(row.column_blob(3)), row.column_integer(2),
                         crc_when_dropped(row.column_blob(4), row.column_blob(5),
                                          row.column_integer(6), row.column_integer(7))});
}

void read_pairs(Connection& connection, PreparedAttempts attempts, std::uint64_t max_paths,
                BatchState& state) {
  const WantedPairs pairs = pairs_of(attempts, state);
  const WantedContents contents = contents_of(attempts, state);
  const std::string of_reports = paths_of_reports(), of_contents = paths_of_contents();
  const Parameters uuids(uuids_of(attempts));
  const auto paths = std::ranges::count_if(
      attempts, [](const PreparedAttempt* each) { return each->path.has_value(); });
  std::vector<Request> requests = {
      {kMakeTasks, Parameters(pairs.new_tasks)},
      {kLockTasks, Parameters(pairs.tasks)},
      {kMakePairs, Parameters(pairs.tasks, pairs.robots)},
      {kLockPairs, Parameters(pairs.tasks, pairs.robots)},
      // Later statements see all commits from before the locks were taken.
      {kReports, uuids},
      {of_reports, uuids},
      {kRetired, uuids},
      {of_contents, Parameters(contents.tasks, contents.robots, contents.contents)},
      {kScenes, Parameters(scenes_of(attempts))},
      {kPathIds, Parameters(static_cast<std::int64_t>(paths))}};
  if (max_paths > 0)
    requests.push_back({kLargest, Parameters(pairs.tasks, pairs.robots, pairs.paths,
                                             static_cast<std::int64_t>(max_paths),
                                             static_cast<std::int64_t>(kMaxDroppedAtOnce))});
  const std::vector<Rows> rows = connection.query_all(requests);
  take_pairs(rows[3], state);
  take_reports(rows[4], rows[5], state);
  for (const PreparedAttempt* const each : attempts)
    require_pair(state, pair_name(*each, state));
  for (const Row row : rows[6])
    state.retired.insert(id_of<Uuid>(row.column_blob(0)));
  take_contents(rows[7], state);
  for (const Row row : rows[8])
    state.scenes[id_of<Digest>(row.column_blob(0))] = row.column_integer(1) != 0;
  for (const Row row : rows[9])
    state.path_ids.push_back(row.column_integer(0));
  if (max_paths > 0)
    take_largest(rows[10], state);
}

}  // namespace

BatchState read_state(Connection& connection, PreparedAttempts attempts, std::uint64_t max_paths) {
  BatchState state;
  read_robots(connection, attempts, state);
  const std::vector<const PreparedAttempt*> rest = acceptable(attempts, state);
  if (!rest.empty()) {
    const auto refused = state.reports;
    read_pairs(connection, rest, max_paths, state);
    state.reports.insert(refused.begin(), refused.end());
  }
  return state;
}

std::uint32_t crc_when_dropped(Bytes report_uuid, Bytes T_task_base, std::int64_t dof,
                               std::int64_t waypoint_count) {
  return PathContent{report_uuid,    T_task_base,        dof,
                     waypoint_count, kEncodingOfDropped, Bytes(kNoWaypoints)}
      .crc();
}

}  // namespace kinship::store::postgres
