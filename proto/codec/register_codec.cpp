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
  return check_mesh_solids(description.mesh_solids);
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
