#include "proto/codec/register_codec.hpp"

#include <cstddef>

#include "proto/codec/fields.hpp"
#include "proto/codec/scene_codec.hpp"
#include "proto/types/names.hpp"

namespace kinship::codec {

using HeldJoints = decltype(RobotDescription::held_joints);

template <>
struct WireMember<TaskAxes> {
  using Type = bool[6];
};
template <>
struct WireMember<HeldJoints> {
  using Type = decltype(kinship_wire_RegisterRequest::held_joints);
};
template <>
struct WireMember<std::vector<NamePair>> {
  using Type = decltype(kinship_wire_RegisterRequest::never_colliding);
};
template <>
struct WireMember<std::vector<MeshDigest>> {
  using Type = decltype(kinship_wire_RegisterReply::wanted);
};

namespace {

/// The members of a request before its solids, which are one value and two members.
constexpr std::tuple kFields{
    Field{"label", &RobotDescription::label, {.check = check_label}},
    Field{"urdf", &RobotDescription::urdf, {.limit = kMaxUrdfBytes}},
    Field{"base_link", &RobotDescription::base_link, {.limit = kMaxLinkNameBytes}},
    Field{"tip_link", &RobotDescription::tip_link, {.limit = kMaxLinkNameBytes}},
    Field{"T_tip_transfer", &RobotDescription::T_tip_transfer},
    Field{"task_axes", &RobotDescription::task_axes},
    Field{"held_joints", &RobotDescription::held_joints, {.limit = kMaxHeldJoints}},
    Field{"never_colliding", &RobotDescription::never_colliding, {.limit = kMaxCollisionPairs}}};
constexpr std::size_t kBegin = head_bytes<kinship_wire_RegisterRequest>();
static_assert(size_of_message<kinship_wire_RegisterRequest>(kFields, kBegin) ==
              offsetof(kinship_wire_RegisterRequest, mesh_solids));

}  // namespace

static void write_part(const TaskAxes& axes, Arena& /*arena*/, bool (&wire)[6]) {
  std::copy(axes.matters.begin(), axes.matters.end(), std::begin(wire));
}

static void read_part(const bool (&wire)[6], Reader& /*reader*/, TaskAxes& axes) {
  std::copy(std::begin(wire), std::end(wire), axes.matters.begin());
}

static void write_part(const HeldJoints& joints, Arena& arena, WireMember<HeldJoints>::Type& wire) {
  arena.resize(wire, joints.size());
  std::size_t i = 0;
  for (const auto& [joint, position] : joints)
    wire._buffer[i++] = {arena.text(joint), position};
}

static void read_part(const WireMember<HeldJoints>::Type& wire, Reader& reader,
                      HeldJoints& joints) {
  for (const auto& held : elements(wire))
    if (!joints.emplace(read_text(held.joint), held.position).second)
      reader.rules.that(false, "held joint '" + read_text(held.joint) + "': is there twice");
}

static void write_part(const LinkSolid& solid, Arena& arena, kinship_wire_LinkSolid& wire) {
  wire.link = arena.text(solid.link);
  write_shape(solid.shape, wire);
  write_pose(solid.T_link_shape, wire.pose);
}

static void read_part(const kinship_wire_LinkSolid& wire, Reader& reader, LinkSolid& solid) {
  solid.link = read_text(wire.link);
  solid.shape = read_shape("mesh_solids: shape", wire, reader);
  solid.T_link_shape = reader.pose("mesh_solids", wire.pose);
}

static void write_part(const LinkMesh& mesh, Arena& arena, kinship_wire_LinkMesh& wire) {
  wire.link = arena.text(mesh.link);
  wire.role = static_cast<std::uint32_t>(mesh.role);
  write_pose(mesh.T_link_mesh, wire.T_link_mesh);
  write_value(mesh.rgba, {}, arena, wire.rgba);
  wire.error_m = mesh.error_m;
  write_digest(mesh.content, wire.content);
}

static void read_part(const kinship_wire_LinkMesh& wire, Reader& reader, LinkMesh& mesh) {
  mesh.link = read_text(wire.link);
  mesh.role = reader.enumerator("meshes: role", wire.role, MeshRole::Both);
  mesh.T_link_mesh = reader.pose("meshes", wire.T_link_mesh);
  mesh.rgba = read_value<std::vector<double>>({"meshes: rgba"}, wire.rgba, {.limit = 4}, reader);
  mesh.error_m = wire.error_m;
  mesh.content = read_digest(wire.content);
}

static void write_part(const MeshContent& content, Arena& arena, kinship_wire_MeshContent& wire) {
  wire.bytes = content.bytes;
  arena.resize(wire.zlib, content.zlib.size());
  std::copy(content.zlib.begin(), content.zlib.end(), wire.zlib._buffer);
}

static void read_part(const kinship_wire_MeshContent& wire, Reader& reader, MeshContent& content) {
  const auto zlib = elements(wire.zlib);
  reader.rules.at_most("contents: bytes", wire.bytes, kMaxCanonicalMeshBytes)
      .at_most("contents: zlib", zlib.size(), kMaxMeshZlibBytes);
  if (reader.rules.broken())
    return;
  content.bytes = wire.bytes;
  content.zlib.assign(zlib.begin(), zlib.end());
}

std::optional<Error> validate(const RobotDescription& description) {
  Rules rules;
  rules.not_empty("urdf", description.urdf)
      .not_empty("base_link", description.base_link)
      .not_empty("tip_link", description.tip_link)
      .pose("T_tip_transfer", description.T_tip_transfer);
  check_members<kFields>(description, rules);
  if (rules.broken())
    return rules.broken();
  for (const auto& [joint, position] : description.held_joints)
    rules.not_empty("held joint", joint)
        .text("held joint", joint, kMaxLinkNameBytes)
        .finite("position of held joint", position);
  for (const auto& [first, second] : description.never_colliding)
    for (const std::string* link : {&first, &second})
      rules.not_empty("never_colliding", *link).text("never_colliding", *link, kMaxLinkNameBytes);
  if (rules.broken())
    return rules.broken();
  rules.name(check_mesh_solids(description.mesh_solids))
      .name(check_link_meshes(description.meshes))
      .at_most("contents", description.contents.size(), kMaxContentsARequest);
  for (const MeshContent& content : description.contents)
    rules.at_most("contents: bytes", content.bytes, kMaxCanonicalMeshBytes)
        .at_most("contents: zlib", content.zlib.size(), kMaxMeshZlibBytes);
  return rules.broken();
}

Result<Message<kinship_wire_RegisterRequest>> encode(const Head& head,
                                                     const RobotDescription& description) {
  if (const auto error = validate(description))
    return *error;
  Message<kinship_wire_RegisterRequest> message(head);
  Arena& arena = *message.arena;
  auto& wire = message.wire;
  write_members(description, kFields, kBegin, arena, wire);
  write_value(description.mesh_solids.solids, {}, arena, wire.mesh_solids);
  write_value(description.mesh_solids.unfiltered, {}, arena, wire.unfiltered);
  write_value(description.meshes, {}, arena, wire.meshes);
  write_value(description.contents, {}, arena, wire.contents);
  return limited(std::move(message));
}

Result<RobotDescription> decode(const kinship_wire_RegisterRequest& wire) {
  Reader reader;
  RobotDescription description;
  read_members(wire, kFields, kBegin, reader, description);
  description.mesh_solids.solids = read_value<std::vector<LinkSolid>>(
      {"mesh_solids"}, wire.mesh_solids, {.limit = kMaxMeshSolids}, reader);
  description.mesh_solids.unfiltered = read_value<std::vector<NamePair>>(
      {"unfiltered"}, wire.unfiltered, {.limit = kMaxCollisionPairs}, reader);
  description.meshes =
      read_value<std::vector<LinkMesh>>({"meshes"}, wire.meshes, {.limit = kMaxLinkMeshes}, reader);
  description.contents = read_value<std::vector<MeshContent>>(
      {"contents"}, wire.contents, {.limit = kMaxContentsARequest}, reader);
  if (!reader.rules.broken())
    reader.rules.name(validate(description));
  if (reader.rules.broken())
    return *reader.rules.broken();
  return description;
}

Result<Message<kinship_wire_RegisterReply>> encode(const Head& head, const RegisterReply& reply) {
  return encode_fields(reply, Message<kinship_wire_RegisterReply>(head));
}

Result<RegisterReply> decode(const kinship_wire_RegisterReply& wire) {
  return decode_fields<RegisterReply>(wire);
}

}  // namespace kinship::codec
