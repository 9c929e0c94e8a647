#include "server/store/postgres/rows/robot_rows.hpp"

#include <utility>

#include "server/store/values/byte_stream.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/mesh_solids_blob.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store::postgres {
namespace {

/// A row of kRobotColumns, without its parts.
struct RobotRow {
  std::int64_t id = 0;
  RobotRecord robot;
  std::vector<std::uint8_t> T_tip_transfer, mesh_solids;
  std::int64_t crc = 0;
};

constexpr std::string_view kRobotColumns =
    "SELECT id, digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes, registered_ms,"
    " crc32c, urdf, revision, taken_ms, mesh_solids FROM robot"
    " LEFT JOIN robot_geometry ON robot_geometry.robot_id = robot.id ";

std::vector<std::uint8_t> copy_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

RobotRow read_row(const Row& row) {
  RobotRow read;
  read.id = row.column_integer(0);
  read.robot.digest = id_of<Digest>(row.column_blob(1));
  read.robot.dof = static_cast<std::uint32_t>(row.column_integer(3));
  read.robot.registered_ms = row.column_integer(8);
  RobotDescription& description = read.robot.description;
  description.label = row.column_text(2);
  description.base_link = row.column_text(4);
  description.tip_link = row.column_text(5);
  description.task_axes = axes_of(row.column_integer(7));
  description.urdf = row.column_text(10);
  read.T_tip_transfer = copy_of(row.column_blob(6));
  read.crc = row.column_integer(9);
  read.robot.geometry_revision = count_of(row, 11);
  read.robot.geometry_ms = row.column_integer(12);
  read.mesh_solids = copy_of(row.column_blob(13));
  return read;
}

void select_parts(Connection& connection, RobotRow& row) {
  RobotDescription& description = row.robot.description;
  for (const Row held :
       connection.query("SELECT joint, position FROM robot_held_joint WHERE robot_id = $1", row.id))
    description.held_joints.emplace(held.column_text(0), held.column_real(1));
  for (const Row pair : connection.query("SELECT link_a, link_b FROM robot_never_colliding"
                                         " WHERE robot_id = $1 ORDER BY ordinal",
                                         row.id))
    description.never_colliding.emplace_back(pair.column_text(0), pair.column_text(1));
}

/// Nothing if it is not what write_robot() wrote.
std::optional<RobotRecord> completed(Connection& connection, RobotRow row) {
  select_parts(connection, row);
  return complete_robot(std::move(row.robot), row.T_tip_transfer, row.mesh_solids, row.crc);
}

std::optional<RobotRow> find_row(Connection& connection, const Digest& robot) {
  const Rows rows =
      connection.query(std::string(kRobotColumns) + "WHERE digest = $1", Bytes(robot.bytes));
  if (rows.empty())
    return std::nullopt;
  return read_row(rows.front());
}

/// \return Conflict if another robot has the label.
std::optional<Error> check_free(Connection& connection, const std::string& label,
                                const Digest& robot) {
  const Rows rows = connection.query("SELECT 1 FROM robot WHERE label = $1 AND digest <> $2", label,
                                     Bytes(robot.bytes));
  return rows.empty() ? std::nullopt : std::optional(label_conflict(label));
}

/// \return the id of the row, the old one if the digest is there; nothing if another robot took
///         its label just now.
std::int64_t upsert_row(Connection& connection, const RobotRecord& robot) {
  const RobotDescription& description = robot.description;
  const std::vector<std::uint8_t> T_tip_transfer = pose_blob(description.T_tip_transfer);
  const Rows rows = connection.query(
      "INSERT INTO robot (digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes,"
      " registered_ms, crc32c, urdf) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)"
      " ON CONFLICT (digest) DO UPDATE SET label = excluded.label, dof = excluded.dof,"
      " base_link = excluded.base_link, tip_link = excluded.tip_link,"
      " T_tip_transfer = excluded.T_tip_transfer, task_axes = excluded.task_axes,"
      " changed_in = excluded.changed_in, registered_ms = excluded.registered_ms, crc32c = "
      "excluded.crc32c, urdf = excluded.urdf"
      " RETURNING id",
      Bytes(robot.digest.bytes), description.label, std::int64_t{robot.dof}, description.base_link,
      description.tip_link, T_tip_transfer, mask_of(description.task_axes), robot.registered_ms,
      std::int64_t{robot_crc(robot, T_tip_transfer, encode_mesh_solids(description.mesh_solids))},
      description.urdf);
  return rows.front().column_integer(0);
}

void delete_parts(Connection& connection, std::int64_t robot_id) {
  connection.query("DELETE FROM robot_held_joint WHERE robot_id = $1", robot_id);
  connection.query("DELETE FROM robot_never_colliding WHERE robot_id = $1", robot_id);
  connection.query("DELETE FROM robot_geometry WHERE robot_id = $1", robot_id);
}

void insert_parts(Connection& connection, std::int64_t robot_id, const RobotRecord& robot) {
  for (const auto& [joint, position] : robot.description.held_joints)
    connection.query("INSERT INTO robot_held_joint VALUES ($1, $2, $3)", robot_id, joint, position);
  std::int64_t ordinal = 0;
  for (const auto& [a, b] : robot.description.never_colliding)
    connection.query("INSERT INTO robot_never_colliding VALUES ($1, $2, $3, $4)", robot_id,
                     ordinal++, a, b);
  if (has_geometry_row(robot))
    connection.query("INSERT INTO robot_geometry VALUES ($1, $2, $3, $4)", robot_id,
                     static_cast<std::int64_t>(robot.geometry_revision), robot.geometry_ms,
                     encode_mesh_solids(robot.description.mesh_solids));
}

/// Writes a robot's rows, anew if they are there.
void write_robot(Connection& connection, const RobotRecord& robot) {
  const std::int64_t id = upsert_row(connection, robot);
  delete_parts(connection, id);
  insert_parts(connection, id, robot);
}

}  // namespace

std::optional<std::int64_t> lock_robot(Connection& connection, const Digest& robot) {
  // Robots are registered, renamed and removed one at a time; reports, which lock rows FOR KEY
  // SHARE, go on with the other robots.
  connection.query("LOCK TABLE robot IN SHARE ROW EXCLUSIVE MODE");
  const Rows rows =
      connection.query("SELECT id FROM robot WHERE digest = $1 FOR UPDATE", Bytes(robot.bytes));
  if (rows.empty())
    return std::nullopt;
  return rows.front().column_integer(0);
}

bool is_registered(Connection& connection, const Digest& robot) {
  std::optional<RobotRow> row = find_row(connection, robot);
  return row && !is_removed_label(row->robot.description.label) &&
         completed(connection, *std::move(row));
}

Result<RegisterStatus> insert_robot(Connection& connection, const RobotRecord& robot) {
  const RobotDescription& description = robot.description;
  static_cast<void>(lock_robot(connection, robot.digest));
  const std::optional<RobotRow> before = find_row(connection, robot.digest);
  if (before && !is_removed_label(before->robot.description.label) &&
      completed(connection, *before))
    return RegisterStatus::Known;  // by another server just now
  if (auto conflict = check_free(connection, description.label, robot.digest))
    return *conflict;
  if (auto fault = find_pose_fault(description))
    return *std::move(fault);
  RobotRecord written = robot;
  // Neither what was fitted with the geometry of before nor a fit that failed over it is its own.
  if (before)
    written.geometry_revision = before->robot.geometry_revision + 1;
  write_robot(connection, written);
  return RegisterStatus::Registered;
}

Result<bool> relabel_robot(Connection& connection, const Digest& robot, const std::string& label) {
  static_cast<void>(lock_robot(connection, robot));
  const std::optional<RobotRow> row = find_row(connection, robot);
  std::optional<RobotRecord> record = select_robot(connection, robot);
  if (!row || !record)
    return Error{ErrorCode::NotFound, "robot " + robot.short_hex() + " is not registered"};
  if (auto conflict = check_free(connection, label, robot))
    return *conflict;
  record->description.label = label;
  connection.query(
      "UPDATE robot SET changed_in = pg_current_xact_id(), label = $1, crc32c = $2 WHERE id = $3",
      label, std::int64_t{robot_crc(*record, row->T_tip_transfer, row->mesh_solids)}, row->id);
  return true;
}

void delete_robot(Connection& connection, std::int64_t robot_id) {
  delete_parts(connection, robot_id);
  connection.query(
      "INSERT INTO gone_robot (digest) SELECT digest FROM robot WHERE id = $1"
      " ON CONFLICT (digest) DO UPDATE SET changed_in = excluded.changed_in",
      robot_id);
  connection.query("DELETE FROM robot WHERE id = $1", robot_id);
}

bool update_robot(Connection& connection, const RobotRecord& robot) {
  static_cast<void>(lock_robot(connection, robot.digest));
  std::optional<RobotRow> row = find_row(connection, robot.digest);
  const std::optional<RobotRecord> written =
      with_better_geometry(row ? completed(connection, *std::move(row)) : std::nullopt, robot);
  if (written)
    write_robot(connection, *written);
  return written.has_value();
}

std::map<Digest, std::uint64_t> select_geometry_revisions(Connection& connection) {
  std::map<Digest, std::uint64_t> revisions;
  for (const Row row : connection.query(
           "SELECT digest, revision FROM robot_geometry JOIN robot ON robot.id = robot_id"
           " WHERE revision > 0"))
    revisions.emplace(id_of<Digest>(row.column_blob(0)), count_of(row, 1));
  return revisions;
}

std::optional<RobotRecord> select_robot(Connection& connection, const Digest& robot) {
  std::optional<RobotRow> row = find_row(connection, robot);
  if (!row || is_removed_label(row->robot.description.label))
    return std::nullopt;
  std::optional<RobotRecord> record = completed(connection, std::move(*row));
  if (!record)
    throw Failure(ErrorCode::Storage, "robot " + robot.short_hex() + ": its row is damaged");
  return record;
}

RobotsRead select_robots(Connection& connection) {
  RobotsRead read;
  for (const Row row : connection.query(std::string(kRobotColumns) + "ORDER BY label")) {
    RobotRow each = read_row(row);
    const std::string label = each.robot.description.label;
    if (is_removed_label(label))
      continue;
    if (std::optional<RobotRecord> robot = completed(connection, std::move(each)))
      read.robots.push_back(std::move(*robot));
    else
      read.damaged.push_back(label);
  }
  return read;
}

}  // namespace kinship::store::postgres
