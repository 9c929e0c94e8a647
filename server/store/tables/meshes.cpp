#include "server/store/tables/meshes.hpp"

#include <algorithm>
#include <string>

#include "server/store/tables/robots.hpp"
#include "server/store/values/columns.hpp"
#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

/// The row that is as it was written.
std::optional<MeshContent> select_sound(Session& session, const std::string& condition,
                                        const Parameter& value) {
  return session.unless_damaged([&]() -> std::optional<MeshContent> {
    const Parameter values[] = {value};
    const Rows rows = session.query_with("SELECT bytes, crc32c, payload FROM mesh WHERE " +
                                             condition + " AND " + session.is_intact("mesh"),
                                         values);
    if (rows.empty())
      return std::nullopt;
    const Row& row = rows.front();
    const Bytes payload = row.column_blob(2);
    if (crc32c(payload) != row.column_integer(1))
      return std::nullopt;
    return MeshContent{static_cast<std::uint32_t>(row.column_integer(0)),
                       {payload.begin(), payload.end()}};
  });
}

std::set<Digest> contents_of(const RobotDescription& description) {
  std::set<Digest> contents;
  for (const LinkMesh& mesh : description.meshes)
    contents.insert(mesh.content);
  return contents;
}

bool is_complete(Session& session, const RobotDescription& description) {
  std::set<Digest> collision;
  for (const LinkMesh& mesh : description.meshes)
    if (is_collision(mesh))
      collision.insert(mesh.content);
  return !collision.empty() && select_known_meshes(session, collision).size() == collision.size();
}

}  // namespace

std::optional<MeshContent> select_mesh(Session& session, const Digest& content) {
  return select_sound(session, "digest = $1", Parameter(content));
}

std::map<Digest, std::uint64_t> select_known_meshes(Session& session,
                                                    const std::set<Digest>& contents) {
  std::map<Digest, std::uint64_t> known;
  for (const Digest& content : contents)
    if (const auto bytes = session.unless_damaged([&] {
          return session.find_integer(
              "SELECT length(payload) FROM mesh WHERE digest = $1 AND " + session.is_intact("mesh"),
              content);
        }))
      known.emplace(content, static_cast<std::uint64_t>(*bytes));
  return known;
}

MeshUse count_meshes(Session& session) {
  return session.unless_damaged([&] {
    const Rows rows = session.query(
        "SELECT count(*), CAST(coalesce(sum(length(payload)), 0) AS bigint) FROM mesh");
    return MeshUse{count_of(rows.front(), 0), count_of(rows.front(), 1)};
  });
}

ReadMeshes::ReadMeshes(const std::vector<MeshContent>& contents) {
  for (const MeshContent& content : contents) {
    const Result<TriangleMesh> mesh = TriangleMesh::read(content);
    if (mesh) {
      meshes.push_back({mesh->digest(), &content});
    } else {
      ++refused;
      why = mesh.error().message;
    }
  }
}

MeshesPut insert_meshes(Session& session, const Digest& robot, const ReadMeshes& contents,
                        const MeshLimits& limits) {
  static_cast<void>(lock_robot(session, robot));
  const std::optional<RobotRecord> record = select_robot(session, robot);
  const std::set<Digest> named = record ? contents_of(record->description) : std::set<Digest>();
  bool has_new_collision = false;
  std::uint64_t used = count_meshes(session).bytes;
  MeshesPut put{.refused = contents.refused, .why = contents.why};
  for (const auto& [digest, content] : contents.meshes) {
    if (!named.contains(digest)) {
      ++put.refused;
      put.why = "mesh " + digest.short_hex() + ": the robot names no such content";
      continue;
    }
    if (select_mesh(session, digest))
      continue;
    if (used + content->zlib.size() > limits.max_bytes) {
      ++put.over;
      continue;
    }
    // A damaged row of it goes.
    session.query("DELETE FROM mesh WHERE digest = $1", digest);
    session.query("INSERT INTO mesh (digest, bytes, crc32c, payload) VALUES ($1, $2, $3, $4)",
                  digest, content->bytes, crc32c(content->zlib), content->zlib);
    used += content->zlib.size();
    ++put.stored;
    has_new_collision =
        has_new_collision ||
        std::ranges::any_of(record->description.meshes, [&of = digest](const LinkMesh& each) {
          return each.content == of && is_collision(each);
        });
  }
  if (has_new_collision && is_complete(session, record->description)) {
    RobotRecord complete = *record;
    ++complete.geometry_revision;
    complete.geometry_ms = limits.now_ms;
    put.is_complete = update_robot(session, complete);
  }
  return put;
}

void drop_unnamed_meshes(Session& session) {
  const RobotsRead robots = select_robots(session);
  if (!robots.damaged.empty())
    return;
  std::set<Digest> named;
  for (const RobotRecord& robot : robots.robots)
    named.merge(contents_of(robot.description));
  std::vector<std::int64_t> unnamed;
  for (const Row& row : session.query("SELECT id, digest FROM mesh"))
    if (!named.contains(id_of<Digest>(row.column_blob(1))))
      unnamed.push_back(row.column_integer(0));
  for (const std::int64_t row : unnamed)
    drop_mesh(session, row);
}

bool is_mesh_sound(Session& session, std::int64_t row) {
  return select_sound(session, "id = $1", Parameter(row)).has_value();
}

void drop_mesh(Session& session, std::int64_t row) {
  static_cast<void>(session.try_change("DELETE FROM mesh WHERE id = $1", row));
}

}  // namespace kinship::store
