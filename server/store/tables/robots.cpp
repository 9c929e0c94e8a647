#include "server/store/tables/robots.hpp"

#include <utility>

#include "server/store/tables/audit.hpp"
#include "server/store/tables/meshes.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/mesh_solids_blob.hpp"
#include "server/store/values/robot_columns.hpp"
#include "server/store/values/summary_columns.hpp"

namespace kinship::store {
namespace {

/// A robot's row and parts, with the bytes that its checksum covers, as stored.
struct StoredRobot {
  RobotRecord robot;
  std::vector<std::uint8_t> T_tip_transfer, mesh_solids;
  std::int64_t crc = 0;
};

std::vector<std::uint8_t> copy_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

StoredRobot read_stored_robot(const Row& row) {
  StoredRobot read;
  RobotDescription& description = read.robot.description;
  read.robot.digest = id_of<Digest>(row.column_blob(0));
  description.label = row.column_text(1);
  read.robot.dof = static_cast<std::uint32_t>(row.column_integer(2));
  description.base_link = row.column_text(3);
  description.tip_link = row.column_text(4);
  read.T_tip_transfer = copy_of(row.column_blob(5));
  description.task_axes = axes_of(row.column_integer(6));
  read.robot.registered_ms = row.column_integer(7);
  read.crc = row.column_integer(8);
  description.urdf = row.column_text(9);
  read.robot.geometry_revision = count_of(row, 10);
  read.robot.geometry_ms = row.column_integer(11);
  read.mesh_solids = copy_of(row.column_blob(12));
  return read;
}

void select_parts(Session& session, std::int64_t id, RobotDescription& description) {
  for (const Row& held :
       session.query("SELECT joint, position FROM robot_held_joint WHERE robot_id = $1", id))
    description.held_joints.emplace(held.column_text(0), held.column_real(1));
  for (const Row& pair : session.query("SELECT link_a, link_b FROM robot_never_colliding"
                                       " WHERE robot_id = $1 ORDER BY ordinal",
                                       id))
    description.never_colliding.emplace_back(pair.column_text(0), pair.column_text(1));
}

/// Nothing, also if it is damaged.
std::optional<StoredRobot> select_stored_robot(Session& session, std::int64_t id) {
  return session.unless_damaged([&]() -> std::optional<StoredRobot> {
    const Rows rows = session.query(
        "SELECT digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes, registered_ms,"
        " crc32c, urdf, revision, taken_ms, mesh_solids FROM robot"
        " LEFT JOIN robot_geometry ON robot_geometry.robot_id = robot.id WHERE robot.id = $1 AND " +
            session.is_intact("robot"),
        id);
    if (rows.empty())
      return std::nullopt;
    StoredRobot stored = read_stored_robot(rows.front());
    select_parts(session, id, stored.robot.description);
    return stored;
  });
}

/// Nothing if the row is not as write_robot() wrote it.
std::optional<RobotRecord> completed(const std::optional<StoredRobot>& stored) {
  if (!stored)
    return std::nullopt;
  return complete_robot(stored->robot, stored->T_tip_transfer, stored->mesh_solids, stored->crc);
}

std::optional<RobotRecord> read_robot(Session& session, std::int64_t id) {
  return completed(select_stored_robot(session, id));
}

Failure damaged_row(const Digest& robot) {
  return {ErrorCode::Storage, "robot " + robot.short_hex() + ": its row is damaged"};
}

/// From the indexes. \return Conflict, with a remedy, if another robot has the label.
std::optional<Error> check_free(Session& session, const std::string& label, const Digest& robot) {
  const auto has_label = session.find_integer("SELECT id FROM robot WHERE label = $1", label);
  if (!has_label ||
      has_label == session.find_integer("SELECT id FROM robot WHERE digest = $1", robot))
    return std::nullopt;
  return label_conflict(label);
}

/// \return the id of the row, the old one if the digest is there.
std::int64_t upsert_row(Session& session, const RobotRecord& robot) {
  const RobotDescription& description = robot.description;
  const std::vector<std::uint8_t> T_tip_transfer = pose_blob(description.T_tip_transfer);
  const auto id = session.find_integer(
      "INSERT INTO robot (digest, label, dof, base_link, tip_link, T_tip_transfer, task_axes,"
      " registered_ms, crc32c, urdf) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)"
      // The digest too: an index may lead to a row in which it is damaged.
      " ON CONFLICT (digest) DO UPDATE SET digest = excluded.digest, label = excluded.label,"
      " dof = excluded.dof,"
      " base_link = excluded.base_link, tip_link = excluded.tip_link,"
      " T_tip_transfer = excluded.T_tip_transfer, task_axes = excluded.task_axes,"
      " registered_ms = excluded.registered_ms, crc32c = excluded.crc32c, urdf = excluded.urdf" +
          std::string(session.dialect().mark_changed) + " RETURNING id",
      robot.digest, description.label, robot.dof, description.base_link, description.tip_link,
      T_tip_transfer, mask_of(description.task_axes), robot.registered_ms,
      robot_crc(robot, T_tip_transfer, encode_geometry(description)), description.urdf);
  return id.value();
}

void delete_parts(Session& session, std::int64_t robot_id) {
  session.query("DELETE FROM robot_held_joint WHERE robot_id = $1", robot_id);
  session.query("DELETE FROM robot_never_colliding WHERE robot_id = $1", robot_id);
  session.query("DELETE FROM robot_geometry WHERE robot_id = $1", robot_id);
}

void insert_parts(Session& session, std::int64_t robot_id, const RobotRecord& robot) {
  for (const auto& [joint, position] : robot.description.held_joints)
    session.query("INSERT INTO robot_held_joint VALUES ($1, $2, $3)", robot_id, joint, position);
  std::int64_t ordinal = 0;
  for (const auto& [a, b] : robot.description.never_colliding)
    session.query("INSERT INTO robot_never_colliding VALUES ($1, $2, $3, $4)", robot_id, ordinal++,
                  a, b);
  if (has_geometry_row(robot))
    session.query(
        "INSERT INTO robot_geometry (robot_id, revision, taken_ms, mesh_solids)"
        " VALUES ($1, $2, $3, $4)",
        robot_id, robot.geometry_revision, robot.geometry_ms, encode_geometry(robot.description));
}

/// Writes a robot's rows, anew if they are there.
void write_robot(Session& session, const RobotRecord& robot) {
  const std::int64_t id = upsert_row(session, robot);
  delete_parts(session, id);
  insert_parts(session, id, robot);
}

std::optional<std::int64_t> geometry_revision_of(Session& session, std::int64_t robot_id) {
  return session.find_integer("SELECT revision FROM robot_geometry WHERE robot_id = $1 AND " +
                                  session.is_intact("robot_geometry"),
                              robot_id);
}

/// The names of all robots, as far as their rows are in the indexes: also of damaged rows.
std::map<std::int64_t, RobotName> names_in_indexes(Session& session) {
  std::map<std::int64_t, RobotName> names;
  for (const Row& row : session.query("SELECT id, digest FROM robot ORDER BY digest"))
    names[row.column_integer(0)].digest = id_of<Digest>(row.column_blob(1));
  for (const Row& row : session.query("SELECT id, label FROM robot ORDER BY label"))
    names[row.column_integer(0)].label = row.column_text(1);
  return names;
}

}  // namespace

std::optional<std::int64_t> find_registered(Session& session, const Digest& robot) {
  const auto id = session.find_integer(
      "SELECT id FROM robot WHERE digest = $1"
      " AND NOT EXISTS (SELECT 1 FROM robot AS removed WHERE removed.label = $2)",
      robot, removed_label(robot));
  if (!id)
    session.require_absent("robot", "digest", Parameter(robot));
  return id;
}

bool is_robot_readable(Session& session, std::int64_t id) {
  return read_robot(session, id).has_value();
}

bool is_registered(Session& session, const Digest& robot) {
  const std::optional<std::int64_t> id = find_registered(session, robot);
  return id && read_robot(session, *id);
}

std::optional<std::int64_t> lock_robot(Session& session, const Digest& robot) {
  if (!session.dialect().lock_robots.empty())
    session.query(session.dialect().lock_robots);
  const auto id = session.find_integer(
      "SELECT id FROM robot WHERE digest = $1" + std::string(session.dialect().for_update), robot);
  if (!id)
    session.require_absent("robot", "digest", Parameter(robot));
  return id;
}

Result<RegisterStatus> insert_robot(Session& session, const RobotRecord& robot) {
  const std::optional<std::int64_t> before = lock_robot(session, robot.digest);
  if (before && is_registered(session, robot.digest))
    return RegisterStatus::Known;
  if (auto conflict = check_free(session, robot.description.label, robot.digest))
    return *conflict;
  if (auto fault = find_pose_fault(robot.description))
    return *std::move(fault);
  RobotRecord written = robot;
  // Neither a distribution of the earlier geometry nor a fit that failed over it is its own.
  if (before)
    written.geometry_revision =
        static_cast<std::uint64_t>(geometry_revision_of(session, *before).value_or(0)) + 1;
  write_robot(session, written);
  return RegisterStatus::Registered;
}

bool update_robot(Session& session, const RobotRecord& robot) {
  const std::optional<std::int64_t> id = lock_robot(session, robot.digest);
  const std::optional<RobotRecord> written =
      with_better_geometry(id ? read_robot(session, *id) : std::nullopt, robot);
  if (!written)
    return false;
  write_robot(session, *written);
  drop_unnamed_meshes(session);
  return true;
}

Result<bool> relabel_robot(Session& session, const Digest& robot, const std::string& label) {
  static_cast<void>(lock_robot(session, robot));
  const std::optional<std::int64_t> id = find_registered(session, robot);
  if (!id)
    return Error{ErrorCode::NotFound, "robot " + robot.short_hex() + " is not registered"};
  const std::optional<StoredRobot> stored = select_stored_robot(session, *id);
  std::optional<RobotRecord> record = completed(stored);
  if (!record)
    throw damaged_row(robot);
  if (auto conflict = check_free(session, label, robot))
    return *conflict;
  record->description.label = label;
  session.query("UPDATE robot SET label = $1, crc32c = $2" +
                    std::string(session.dialect().mark_changed) + " WHERE id = $3",
                label, robot_crc(*record, stored->T_tip_transfer, stored->mesh_solids), *id);
  return true;
}

Result<bool> rename_audited(Session& session, const Digest& robot, const std::string& label,
                            const AuditEntry* audit) {
  static_cast<void>(lock_robot(session, robot));
  const std::optional<RobotRecord> before =
      audit == nullptr ? std::nullopt : select_robot(session, robot);
  Result<bool> renamed = relabel_robot(session, robot, label);
  if (renamed && before)
    note_act(session, audit, AuditOutcome::Done, "'" + before->description.label + "'",
             "'" + label + "' (" + robot.short_hex() + ")");
  return renamed;
}

void delete_robot(Session& session, std::int64_t robot_id) {
  delete_parts(session, robot_id);
  if (!session.dialect().note_gone_robot.empty())
    session.query(session.dialect().note_gone_robot, robot_id);
  session.query("DELETE FROM robot WHERE id = $1", robot_id);
}

std::map<Digest, std::uint64_t> select_geometry_revisions(Session& session) {
  // The digests are in an index: a damaged row of one robot costs the others nothing.
  std::map<Digest, std::uint64_t> revisions;
  for (const Row& robot : session.query("SELECT digest, id FROM robot ORDER BY digest")) {
    const auto revision = session.unless_damaged(
        [&] { return geometry_revision_of(session, robot.column_integer(1)); });
    if (revision.value_or(0) > 0)
      revisions.emplace(id_of<Digest>(robot.column_blob(0)), *revision);
  }
  return revisions;
}

std::optional<RobotRecord> select_robot(Session& session, const Digest& robot) {
  const std::optional<std::int64_t> id = find_registered(session, robot);
  if (!id)
    return std::nullopt;
  std::optional<RobotRecord> record = read_robot(session, *id);
  if (!record || record->digest != robot)
    throw damaged_row(robot);
  return record;
}

RobotsRead select_robots(Session& session) {
  // Both are in the index of labels.
  RobotsRead read;
  for (const Row& row : session.query("SELECT id, label FROM robot ORDER BY label")) {
    if (is_removed_label(row.column_text(1)))
      continue;
    if (std::optional<RobotRecord> robot = read_robot(session, row.column_integer(0)))
      read.robots.push_back(std::move(*robot));
    else
      read.damaged.emplace_back(row.column_text(1));
  }
  return read;
}

Page<RobotSummary> page_of_robots(Session& session, std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  const auto is_intact = [](const Row& row) { return row.column_integer(row.columns() - 1) != 0; };
  std::vector<std::int64_t> ids;  // of the page; 0: intact
  Page<RobotSummary> page = read_page<RobotSummary>(
      // Without base link: a repair of SQLite knew its name alone.
      session.query("SELECT " + std::string(kRobotSummaryColumns) + ", id, " +
                        session.is_intact("robot") +
                        " FROM robot WHERE label > $1 AND base_link <> ''"
                        " AND label NOT LIKE 'removed %' ORDER BY label LIMIT $2",
                    cursor, rows + 1),
      rows,
      [&](const Row& row) {
        ids.push_back(is_intact(row) ? 0 : row.column_integer(row.columns() - 2));
        return ids.back() == 0 ? read_robot_summary(row) : RobotSummary();
      },
      [](const Row& row) { return std::string(row.column_text(1)); });
  std::map<std::int64_t, RobotName> names;
  for (std::size_t i = 0; i < page.rows.size(); ++i) {
    if (ids[i] == 0)
      continue;
    if (names.empty())
      names = names_in_indexes(session);
    page.rows[i].robot = names[ids[i]].digest;
    page.rows[i].label = names[ids[i]].label;
  }
  return page;
}

std::map<std::int64_t, RobotName> select_robot_names(Session& session) {
  std::map<std::int64_t, RobotName> names;
  bool is_whole = true;
  for (const Row& row :
       session.query("SELECT id, digest, label, " + session.is_intact("robot") + " FROM robot")) {
    if (row.column_integer(3) != 0)
      names[row.column_integer(0)] = {id_of<Digest>(row.column_blob(1)),
                                      std::string(row.column_text(2))};
    is_whole = is_whole && row.column_integer(3) != 0;
  }
  if (!is_whole)
    names.merge(names_in_indexes(session));
  return names;
}

}  // namespace kinship::store
