#include "server/store/postgres/rows/batch.hpp"

#include <deque>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include "server/store/postgres/database/postgres_error.hpp"
#include "server/store/postgres/rows/arrivals.hpp"
#include "server/store/values/codes.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/path_content.hpp"
#include "server/store/values/record_columns.hpp"

namespace kinship::store::postgres {
namespace {

using Integers = std::vector<std::int64_t>;
using OptionalIntegers = std::vector<std::optional<std::int64_t>>;
using Blobs = std::vector<Bytes>;
using OptionalBlobs = std::vector<std::optional<Bytes>>;

// A scene that is damaged is written anew under its id: its paths and attempts have it again.
constexpr std::string_view kWriteScenes =
    "INSERT INTO scene (content_sha256, received_ms, size, encoding, crc32c, scene)"
    " SELECT content, $1, size, encoding, crc, bytes"
    " FROM unnest($2, $3, $4, $5, $6) AS new (content, size, encoding, crc, bytes)"
    " ORDER BY content ON CONFLICT (content_sha256) DO UPDATE SET damaged_ms = NULL,"
    " received_ms = excluded.received_ms, size = excluded.size, encoding = excluded.encoding,"
    " crc32c = excluded.crc32c, scene = excluded.scene WHERE scene.damaged_ms IS NOT NULL";

constexpr std::string_view kQuarantine =
    "UPDATE path SET damaged_ms = coalesce(damaged_ms, $1),"
    " replaced_by = coalesce(new.replaced_by, path.replaced_by)"
    " FROM unnest($2, $3) AS new (id, replaced_by) WHERE path.id = new.id";

// Reports that brought the damaged path, or were answered with it, get the new one.
constexpr std::string_view kFollowReplacement =
    "UPDATE attempt SET path_id = new.replaced_by"
    " FROM unnest($1, $2) AS new (id, replaced_by) JOIN path ON path.id = new.id"
    " WHERE new.replaced_by IS NOT NULL AND attempt.report_uuid = path.report_uuid"
    " AND attempt.path_id = new.id";
constexpr std::string_view kFollowReplacementOfSame =
    "UPDATE attempt SET path_id = new.replaced_by"
    " FROM unnest($1, $2) AS new (id, replaced_by)"
    " WHERE new.replaced_by IS NOT NULL AND attempt.path_id = new.id AND attempt.status = 2";

constexpr std::string_view kDrop =
    "UPDATE path SET retired_ms = $1, encoding = 2, crc32c = old.crc, waypoints = $2"
    " FROM unnest($3, $4) AS old (id, crc) WHERE path.id = old.id";

constexpr std::string_view kWritePaths =
    "INSERT INTO path (id, task_id, robot_id, report_uuid, content_sha256, length, T_task_base,"
    " dof, waypoint_count, encoding, crc32c, waypoints, received_ms, retired_ms, scene_id)"
    " SELECT new.id, new.task_id, new.robot_id, new.report_uuid, new.content, new.length,"
    " new.T_task_base, new.dof, new.waypoint_count, new.encoding, new.crc, new.waypoints,"
    " new.received_ms, new.retired_ms, scene.id"
    " FROM unnest($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15) AS new (id,"
    " task_id, robot_id, report_uuid, content, length, T_task_base, dof, waypoint_count, encoding,"
    " crc, waypoints, received_ms, retired_ms, scene)"
    " LEFT JOIN scene ON scene.content_sha256 = new.scene";

constexpr std::string_view kWriteSearches =
    "INSERT INTO search (report_uuid, task_id, robot_id, received_ms, bytes, why, crc32c, payload)"
    " SELECT report_uuid, task_id, robot_id, coalesce(received_ms, $1), bytes, why, crc, payload"
    " FROM unnest($2, $3, $4, $5, $6, $7, $8, $9) AS new (report_uuid, task_id, robot_id,"
    " received_ms, bytes, why, crc, payload)";

constexpr std::string_view kRestore =
    "UPDATE attempt SET path_id = new.path_id, status = new.status"
    " FROM unnest($1, $2, $3) AS new (report_uuid, path_id, status)"
    " WHERE attempt.report_uuid = new.report_uuid";

// A resend is answered when this is where the first answer's rows are: it writes, so that its
// COMMIT waits for the standby too.
constexpr std::string_view kNoteResent =
    "UPDATE attempt SET resent = resent + 1 WHERE report_uuid = ANY($1)";

/// Poses as blobs, which stay where they are while columns point to them.
class PoseBlobs {
 public:
  std::optional<Bytes> add(const std::optional<Eigen::Isometry3d>& T_a_b) {
    return blob_or_null(blobs_.emplace_back(optional_pose_blob(T_a_b)));
  }

 private:
  std::deque<std::optional<std::vector<std::uint8_t>>> blobs_;
};

std::optional<Bytes> scene_of(const PreparedAttempt& prepared) {
  if (!prepared.scene)
    return std::nullopt;
  return Bytes(prepared.scene->content.bytes);
}

Parameters scenes_in_columns(const BatchChanges& changes, std::int64_t now_ms) {
  Blobs contents, bytes;
  Integers sizes, encodings, crcs;
  for (const auto& [content, scene] : changes.scenes) {
    const auto encoding = static_cast<std::int64_t>(scene->blob.encoding);
    contents.emplace_back(content.bytes);
    bytes.emplace_back(scene->blob.bytes);
    sizes.push_back(scene->blob.size);
    encodings.push_back(encoding);
    crcs.push_back(scene_crc(content.bytes, scene->blob.size, encoding, scene->blob.bytes));
  }
  return Parameters(now_ms, contents, sizes, encodings, crcs, bytes);
}

struct DamagedColumns {
  Integers ids;
  OptionalIntegers replaced_by;

  explicit DamagedColumns(const BatchChanges& changes) {
    for (const DamagedPath& path : changes.damaged) {
      ids.push_back(path.id);
      replaced_by.push_back(path.replaced_by);
    }
  }
};

Parameters dropped_in_columns(const BatchChanges& changes, std::int64_t now_ms) {
  Integers ids, crcs;
  for (const KeptPath& path : changes.dropped) {
    ids.push_back(path.id);
    crcs.push_back(path.crc_when_dropped);
  }
  return Parameters(now_ms, Bytes(kNoWaypoints), ids, crcs);
}

/// The columns of kWritePaths.
class PathColumns {
 public:
  void add(const NewPath& path, std::int64_t now_ms) {
    const PreparedPath& prepared = *path.from->path;
    const std::optional<Bytes> pose = poses_.add(path.from->attempt.T_task_base);
    const PathContent content = content_of(path, pose.value_or(Bytes()));
    ids_.push_back(path.id);
    tasks_.push_back(path.key.task_id);
    robots_.push_back(path.key.robot_id);
    uuids_.push_back(content.report_uuid);
    contents_.emplace_back(prepared.content.bytes);
    lengths_.push_back(prepared.length);
    placements_.push_back(pose);
    dofs_.push_back(content.dof);
    counts_.push_back(content.waypoint_count);
    encodings_.push_back(content.encoding);
    crcs_.push_back(content.crc());
    waypoints_.push_back(content.waypoints);
    received_.push_back(path.received_ms);
    retired_.push_back(path.is_dropped || path.is_retired ? std::optional(now_ms) : std::nullopt);
    scenes_.push_back(scene_of(*path.from));
  }

  Parameters parameters() const {
    return Parameters(ids_, tasks_, robots_, uuids_, contents_, lengths_, placements_, dofs_,
                      counts_, encodings_, crcs_, waypoints_, received_, retired_, scenes_);
  }

 private:
  PoseBlobs poses_;
  Integers ids_, tasks_, robots_, dofs_, counts_, encodings_, crcs_, received_;
  OptionalIntegers retired_;
  std::vector<double> lengths_;
  Blobs uuids_, contents_, waypoints_;
  OptionalBlobs placements_, scenes_;
};

/// Writes attempts from the parameters of AttemptColumns.
std::string insertion_of_attempts() {
  constexpr int kFirst = 2, kBeforeRecord = 10;
  std::string places;
  for (int place = kFirst; place < kFirst + kBeforeRecord + kRecordColumns; ++place)
    places += (place == kFirst ? "$" : ", $") + std::to_string(place);
  return "INSERT INTO attempt (report_uuid, body_sha256, task_id, robot_id, path_id, status,"
         " machine, T_task_base, received_ms, scene_id, " +
         record_columns() +
         ") SELECT new.report_uuid, new.body, new.task_id, new.robot_id, new.path_id, new.status,"
         " new.machine, new.T_task_base, coalesce(new.received_ms, $1), scene.id, " +
         record_columns("new.") + "FROM unnest(" + places +
         ") WITH ORDINALITY AS new (report_uuid, body, task_id, robot_id, path_id, status, machine,"
         " T_task_base, received_ms, scene, " +
         record_columns() +
         ", place) LEFT JOIN scene ON scene.content_sha256 = new.scene"
         " ORDER BY new.place ON CONFLICT (report_uuid) DO NOTHING";
}

/// The columns of records, one list each.
template <typename Value>
using ColumnList =
    std::vector<std::conditional_t<std::is_same_v<Value, std::string_view>, std::string, Value>>;
template <typename... Of, typename... T>
std::tuple<ColumnList<ColumnValue<T>>...> lists_of(const std::tuple<Field<Of, T>...>& fields);
using RecordLists = decltype(lists_of(kFieldsOf<PlanningRecord>));

class AttemptColumns {
 public:
  void add(const NewAttempt& added) {
    const Attempt& attempt = added.from->attempt;
    uuids_.emplace_back(attempt.report_uuid.bytes);
    bodies_.emplace_back(added.from->body.bytes);
    tasks_.push_back(added.key.task_id);
    robots_.push_back(added.key.robot_id);
    paths_.push_back(added.path_id);
    statuses_.push_back(static_cast<std::int64_t>(added.status));
    machines_.push_back(attempt.machine);
    placements_.push_back(poses_.add(attempt.T_task_base));
    received_.push_back(added.from->received_ms);
    scenes_.push_back(scene_of(*added.from));
    add(attempt.record, std::make_index_sequence<kRecordColumns>());
  }

  Parameters parameters(std::int64_t received_ms) const {
    Parameters all(received_ms, uuids_, bodies_, tasks_, robots_, paths_, statuses_, machines_,
                   placements_, received_, scenes_);
    std::apply([&all](const auto&... lists) { (all.add(lists), ...); }, records_);
    return all;
  }

 private:
  template <std::size_t... I>
  void add(const PlanningRecord& record, std::index_sequence<I...> /*fields*/) {
    (std::get<I>(records_).emplace_back(
         column_value(record.*std::get<I>(kFieldsOf<PlanningRecord>).member)),
     ...);
  }

  PoseBlobs poses_;
  Integers tasks_, robots_, statuses_;
  OptionalIntegers paths_, received_;
  std::vector<std::string> machines_;
  Blobs uuids_, bodies_;
  OptionalBlobs placements_, scenes_;
  RecordLists records_;
};

/// The columns of kWriteSearches, of the attempts that have a search record.
struct SearchColumns {
  Blobs uuids, payloads;
  Integers tasks, robots, sizes, crcs;
  OptionalIntegers received;
  std::vector<std::string> reasons;

  explicit SearchColumns(const std::vector<NewAttempt>& attempts) {
    for (const NewAttempt& added : attempts)
      if (added.from->search)
        add(added, *added.from->search);
  }
  void add(const NewAttempt& added, const PreparedSearch& search) {
    uuids.emplace_back(added.from->attempt.report_uuid.bytes);
    payloads.emplace_back(search.payload);
    tasks.push_back(added.key.task_id);
    robots.push_back(added.key.robot_id);
    sizes.push_back(static_cast<std::int64_t>(search.bytes()));
    crcs.push_back(crc32c(search.payload));
    received.push_back(added.from->received_ms);
    reasons.push_back(search.why);
  }
};

Parameters restored_in_columns(const BatchChanges& changes) {
  Blobs uuids;
  OptionalIntegers paths;
  Integers statuses;
  for (const RestoredReport& attempt : changes.restored) {
    uuids.emplace_back(attempt.report_uuid.bytes);
    paths.push_back(attempt.path_id);
    statuses.push_back(static_cast<std::int64_t>(attempt.status));
  }
  return Parameters(uuids, paths, statuses);
}

/// Its parameters are pairs_in_columns().
std::string change_of_pairs() {
  std::string set, names, places = "$1, $2, $3";
  int place = 3;
  for_each_sum({}, [&](std::string_view mode, std::string_view column, auto /*change*/) {
    const std::string name = std::string(mode).append(column);
    set += ", " + name + " = old." + name + " + new." + name;
    names += ", " + name;
    places += ", $" + std::to_string(++place);
  });
  return "UPDATE experience AS old SET changed_in = pg_current_xact_id(),"
         " generation = old.generation + new.changed" +
         set + " FROM unnest(" + places + ") AS new (task_id, robot_id, changed" + names +
         ") WHERE old.task_id = new.task_id AND old.robot_id = new.robot_id";
}

Parameters pairs_in_columns(const BatchChanges& changes) {
  Integers tasks, robots, changed;
  std::vector<std::variant<Integers, std::vector<double>>> sums;
  for (const auto& [key, change] : changes.pairs) {
    tasks.push_back(key.task_id);
    robots.push_back(key.robot_id);
    changed.push_back(change.is_changed ? 1 : 0);
    std::size_t place = 0;
    for_each_sum(change,
                 [&]<typename T>(std::string_view /*mode*/, std::string_view /*column*/, T added) {
                   if (place == sums.size())
                     sums.emplace_back(std::vector<T>());
                   std::get<std::vector<T>>(sums[place++]).push_back(added);
                 });
  }
  Parameters parameters(tasks, robots, changed);
  for (const auto& column : sums)
    std::visit([&parameters](const auto& list) { parameters.add(list); }, column);
  return parameters;
}

std::vector<Request> requests_of(const BatchChanges& changes, std::int64_t now_ms) {
  std::vector<Request> requests;
  if (!changes.scenes.empty())
    requests.push_back({kWriteScenes, scenes_in_columns(changes, now_ms)});
  if (!changes.damaged.empty()) {
    const DamagedColumns damaged(changes);
    requests.push_back({kQuarantine, Parameters(now_ms, damaged.ids, damaged.replaced_by)});
  }
  if (!changes.dropped.empty())
    requests.push_back({kDrop, dropped_in_columns(changes, now_ms)});
  if (!changes.paths.empty()) {
    PathColumns columns;
    for (const NewPath& path : changes.paths)
      columns.add(path, now_ms);
    requests.push_back({kWritePaths, columns.parameters()});
  }
  if (!changes.damaged.empty()) {
    const DamagedColumns damaged(changes);
    const Parameters parameters(damaged.ids, damaged.replaced_by);
    requests.push_back({kFollowReplacement, parameters});
    requests.push_back({kFollowReplacementOfSame, parameters});
  }
  if (!changes.restored.empty())
    requests.push_back({kRestore, restored_in_columns(changes)});
  if (!changes.resent.empty()) {
    Blobs uuids;
    for (const Uuid& uuid : changes.resent)
      uuids.emplace_back(uuid.bytes);
    requests.push_back({kNoteResent, Parameters(uuids)});
  }
  static const std::string change_pairs = change_of_pairs();
  if (!changes.pairs.empty())
    requests.push_back({change_pairs, pairs_in_columns(changes)});
  if (const SearchColumns columns(changes.attempts); !columns.uuids.empty())
    requests.push_back(
        {kWriteSearches,
         Parameters(now_ms, columns.uuids, columns.tasks, columns.robots, columns.received,
                    columns.sizes, columns.reasons, columns.crcs, columns.payloads)});
  return requests;
}

}  // namespace

void write_changes(Connection& connection, const BatchChanges& changes, std::int64_t now_ms) {
  static const std::string write_attempts = insertion_of_attempts();
  std::vector<Request> requests = requests_of(changes, now_ms);
  AttemptColumns columns;
  for (const NewAttempt& attempt : changes.attempts)
    columns.add(attempt);
  requests.push_back({write_attempts, columns.parameters(now_ms)});
  const std::vector<Rows> rows = connection.query_all(requests);
  if (rows.back().changed() == std::ssize(changes.attempts))
    return;
  std::vector<Uuid> reports;
  for (const NewAttempt& attempt : changes.attempts)
    reports.push_back(attempt.from->attempt.report_uuid);
  if (select_known(connection, reports).size() < reports.size())
    throw PostgresError("27000", "a trigger or a rule of the database takes reports away");
  throw PostgresError("40001", "another server wrote one of these reports meanwhile");
}

}  // namespace kinship::store::postgres
