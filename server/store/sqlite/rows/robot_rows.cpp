#include "server/store/sqlite/rows/robot_rows.hpp"

#include <string>
#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/mesh_solids_blob.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kRobotColumns =
    "SELECT id, digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes, registered_ms,"
    " crc32c, urdf FROM robot ";

void insert_parts(Database& database, std::int64_t robot_id, const RobotDescription& description) {
  for (const auto& [joint, position] : description.held_joints)
    database.cached("INSERT INTO robot_held_joint VALUES (?, ?, ?)")
        ->bind_all(robot_id, std::string_view(joint), position)
        .run();
  std::int64_t ordinal = 0;
  for (const auto& [a, b] : description.never_colliding)
    database.cached("INSERT INTO robot_never_colliding VALUES (?, ?, ?, ?)")
        ->bind_all(robot_id, ordinal++, std::string_view(a), std::string_view(b))
        .run();
}

void insert_geometry(Database& database, std::int64_t robot_id, const RobotRecord& robot) {
  if (has_geometry_row(robot))
    database.cached("INSERT INTO robot_geometry VALUES (?, ?, ?, ?)")
        ->bind_all(robot_id, static_cast<std::int64_t>(robot.geometry_revision), robot.geometry_ms,
                   Bytes(encode_mesh_solids(robot.description.mesh_solids)))
        .run();
}

void select_parts(Database& database, std::int64_t robot_id, RobotDescription& description) {
  const auto held =
      database.cached("SELECT joint, position FROM robot_held_joint WHERE robot_id = ?");
  held->bind(1, robot_id);
  while (held->step())
    description.held_joints.emplace(held->column_text(0), held->column_real(1));
  const auto pairs = database.cached(
      "SELECT link_a, link_b FROM robot_never_colliding WHERE robot_id = ? ORDER BY ordinal");
  pairs->bind(1, robot_id);
  while (pairs->step())
    description.never_colliding.emplace_back(pairs->column_text(0), pairs->column_text(1));
}

/// \return the bytes of its solids; whether they are any is for their reader to say.
std::vector<std::uint8_t> select_geometry(Database& database, std::int64_t robot_id,
                                          RobotRecord& robot) {
  const auto row = database.cached(
      "SELECT revision, taken_ms, mesh_solids FROM robot_geometry WHERE robot_id = ?");
  if (!row->bind(1, robot_id).step())
    return {};
  robot.geometry_revision = static_cast<std::uint64_t>(row->column_integer(0));
  robot.geometry_ms = row->column_integer(1);
  const Bytes solids = row->column_blob(2);
  return {solids.begin(), solids.end()};
}

/// Empty if the row is not what insert_robot() wrote.
std::optional<RobotRecord> read_robot(Database& database, const Statement& row) {
  RobotRecord robot;
  robot.digest = id_of<Digest>(row.column_blob(1));
  robot.dof = static_cast<std::uint32_t>(row.column_integer(3));
  robot.registered_ms = row.column_integer(8);
  RobotDescription& description = robot.description;
  description.label = row.column_text(2);
  description.base_link = row.column_text(4);
  description.tip_link = row.column_text(5);
  description.task_axes = axes_of(row.column_integer(7));
  description.urdf = row.column_text(10);
  select_parts(database, row.column_integer(0), description);
  const std::vector<std::uint8_t> solids = select_geometry(database, row.column_integer(0), robot);
  return complete_robot(std::move(robot), row.column_blob(6), solids, row.column_integer(9));
}

/// Nothing, also if the row lies on a damaged page.
std::optional<RobotRecord> read_robot_of(Database& database, std::int64_t id) {
  try {
    const auto query = database.cached(std::string(kRobotColumns) + "WHERE id = ?");
    if (!query->bind(1, id).step())
      return std::nullopt;
    return read_robot(database, *query);
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return std::nullopt;
  }
}

/// From the index.
std::optional<std::int64_t> id_of_robot(Database& database, const Digest& digest) {
  const auto query = database.cached("SELECT id FROM robot WHERE digest = ?");
  if (!query->bind(1, Bytes(digest.bytes)).step())
    return std::nullopt;
  return query->column_integer(0);
}

bool is_registered(Database& database, const Digest& digest) {
  const std::optional<std::int64_t> id = id_of_robot(database, digest);
  return id && !is_removed(database, digest) && read_robot_of(database, *id);
}

/// From the index of labels. \return Conflict if another robot has it, and what can be done.
std::optional<Error> check_free(Database& database, const std::string& label, const Digest& robot) {
  const auto query = database.cached("SELECT id FROM robot WHERE label = ?");
  query->bind(1, std::string_view(label));
  if (!query->step() || query->column_integer(0) == id_of_robot(database, robot))
    return std::nullopt;
  return label_conflict(label);
}

/// \return the id of the row, the old one if the digest is there.
std::int64_t upsert_row(Database& database, const RobotRecord& robot) {
  const RobotDescription& description = robot.description;
  const std::vector<std::uint8_t> T_tip_transfer = pose_blob(description.T_tip_transfer);
  const auto row = database.cached(
      "INSERT INTO robot (digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes,"
      " registered_ms, crc32c, urdf) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
      "ON CONFLICT (digest) DO UPDATE SET label = excluded.label, dof = excluded.dof,"
      " base_link = excluded.base_link, tip_link = excluded.tip_link,"
      " T_tip_transfer = excluded.T_tip_transfer, task_axes = excluded.task_axes,"
      " registered_ms = excluded.registered_ms, crc32c = excluded.crc32c, urdf = excluded.urdf "
      "RETURNING id");
  row->bind_all(
      Bytes(robot.digest.bytes), std::string_view(description.label), std::int64_t{robot.dof},
      std::string_view(description.base_link), std::string_view(description.tip_link),
      T_tip_transfer, mask_of(description.task_axes), robot.registered_ms,
      std::int64_t{robot_crc(robot, T_tip_transfer, encode_mesh_solids(description.mesh_solids))},
      std::string_view(description.urdf));
  row->step();
  const std::int64_t id = row->column_integer(0);
  row->step();  // to the end, as a statement that writes must
  return id;
}

void delete_parts(Database& database, std::int64_t robot_id) {
  database.cached("DELETE FROM robot_held_joint WHERE robot_id = ?")->bind(1, robot_id).run();
  database.cached("DELETE FROM robot_never_colliding WHERE robot_id = ?")->bind(1, robot_id).run();
  database.cached("DELETE FROM robot_geometry WHERE robot_id = ?")->bind(1, robot_id).run();
}

/// Writes a robot's rows, anew if they are there.
void write_robot(Database& database, const RobotRecord& robot) {
  const std::int64_t id = upsert_row(database, robot);
  delete_parts(database, id);
  insert_parts(database, id, robot.description);
  insert_geometry(database, id, robot);
}

/// Of a robot whose row is written anew because it is damaged or removed: neither what was fitted
/// with its geometry nor a fit that failed over it is taken for its own.
std::uint64_t next_revision(Database& database, std::int64_t id) {
  RobotRecord robot;
  select_geometry(database, id, robot);
  return robot.geometry_revision + 1;
}

}  // namespace

Result<RegisterStatus> insert_robot(Database& database, const RobotRecord& robot) {
  const RobotDescription& description = robot.description;
  if (is_registered(database, robot.digest))
    return RegisterStatus::Known;
  if (auto conflict = check_free(database, description.label, robot.digest))
    return *conflict;
  if (auto fault = find_pose_fault(description))
    return *std::move(fault);
  RobotRecord written = robot;
  if (const std::optional<std::int64_t> before = id_of_robot(database, robot.digest))
    written.geometry_revision = next_revision(database, *before);
  write_robot(database, written);
  return RegisterStatus::Registered;
}

bool is_removed(Database& database, const Digest& robot) {
  const auto query = database.cached("SELECT label FROM robot WHERE label = ?");
  return query->bind(1, std::string_view(removed_label(robot))).step();
}

Result<bool> relabel_robot(Database& database, const Digest& robot, const std::string& label) {
  std::optional<RobotRecord> record = select_robot(database, robot);
  if (!record)
    return Error{ErrorCode::NotFound, "robot " + robot.short_hex() + " is not registered"};
  if (auto conflict = check_free(database, label, robot))
    return *conflict;
  const std::int64_t id = id_of_robot(database, robot).value();
  record->description.label = label;
  // As they are stored: see robot_crc().
  const std::vector<std::uint8_t> solids = select_geometry(database, id, *record);
  std::uint32_t crc = 0;
  {
    const auto pose = database.cached("SELECT T_tip_transfer FROM robot WHERE id = ?");
    pose->bind(1, id).step();
    crc = robot_crc(*record, pose->column_blob(0), solids);
  }
  database.cached("UPDATE robot SET label = ?, crc32c = ? WHERE id = ?")
      ->bind_all(std::string_view(label), std::int64_t{crc}, id)
      .run();
  return true;
}

void delete_robot(Database& database, std::int64_t robot_id) {
  delete_parts(database, robot_id);
  database.cached("DELETE FROM robot WHERE id = ?")->bind(1, robot_id).run();
}

bool update_robot(Database& database, const RobotRecord& robot) {
  const std::optional<std::int64_t> id = id_of_robot(database, robot.digest);
  const std::optional<RobotRecord> written =
      with_better_geometry(id ? read_robot_of(database, *id) : std::nullopt, robot);
  if (written)
    write_robot(database, *written);
  return written.has_value();
}

std::map<Digest, std::uint64_t> select_geometry_revisions(Database& database) {
  // The digests are in an index: a damaged row of one robot costs the others nothing.
  const auto robots = database.cached("SELECT digest, id FROM robot ORDER BY digest");
  std::map<Digest, std::uint64_t> revisions;
  while (robots->step()) {
    RobotRecord robot;
    try {
      select_geometry(database, robots->column_integer(1), robot);
    } catch (const SqliteError& error) {
      if (!error.is_damage())
        throw;
    }
    if (robot.geometry_revision > 0)
      revisions.emplace(id_of<Digest>(robots->column_blob(0)), robot.geometry_revision);
  }
  return revisions;
}

std::optional<RobotRecord> select_robot(Database& database, const Digest& robot) {
  const std::optional<std::int64_t> id = id_of_robot(database, robot);
  if (!id)
    return std::nullopt;
  std::optional<RobotRecord> record = read_robot_of(database, *id);
  if (!record)
    throw Failure(ErrorCode::Storage, "robot " + robot.short_hex() + ": its row is damaged");
  if (is_removed_label(record->description.label))
    return std::nullopt;
  return record;
}

RobotsRead select_robots(Database& database) {
  // Both are in the index of labels.
  const auto query = database.cached("SELECT id, label FROM robot ORDER BY label");
  RobotsRead read;
  while (query->step()) {
    std::optional<RobotRecord> robot = read_robot_of(database, query->column_integer(0));
    if (!robot)
      read.damaged.emplace_back(query->column_text(1));
    else if (!is_removed_label(robot->description.label))
      read.robots.push_back(std::move(*robot));
  }
  return read;
}

}  // namespace kinship::store
