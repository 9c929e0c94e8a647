#include "proto/codec/register_codec.hpp"

#include "proto/codec/fields.hpp"
#include "proto/types/names.hpp"
#include "proto/types/recorded_scene.hpp"

namespace kinship::codec {
namespace {

std::optional<Error> validate(const RegisterReply& reply) {
  Rules rules;
  check_fields(reply, rules);
  return rules.broken();
}

void write_mesh_solids(const MeshSolids& mesh_solids, Arena& arena,
                       kinship_wire_RegisterRequest& wire) {
  arena.resize(wire.mesh_solids, mesh_solids.solids.size());
  for (std::size_t i = 0; i < mesh_solids.solids.size(); ++i) {
    const LinkSolid& solid = mesh_solids.solids[i];
    auto& element = wire.mesh_solids._buffer[i];
    element.link = arena.text(solid.link);
    const ShapeNumbers numbers = to_numbers(solid.shape);
    element.shape = static_cast<std::uint32_t>(numbers.kind);
    std::copy(numbers.sizes.begin(), numbers.sizes.end(), std::begin(element.size));
    const PoseArray pose = to_pose_array(solid.T_link_shape);
    std::copy(pose.begin(), pose.end(), std::begin(element.pose));
  }
  arena.resize(wire.unfiltered, mesh_solids.unfiltered.size());
  for (std::size_t i = 0; i < mesh_solids.unfiltered.size(); ++i) {
    const auto& [first, second] = mesh_solids.unfiltered[i];
    wire.unfiltered._buffer[i] = {arena.text(first), arena.text(second)};
  }
}

MeshSolids read_mesh_solids(const kinship_wire_RegisterRequest& wire, Reader& reader) {
  MeshSolids mesh_solids;
  reader.rules.at_most("mesh_solids", elements(wire.mesh_solids).size(), kMaxMeshSolids)
      .at_most("unfiltered", elements(wire.unfiltered).size(), kMaxCollisionPairs);
  if (reader.rules.broken())
    return mesh_solids;
  constexpr std::uint32_t kLastKind = std::variant_size_v<Shape> - 1;
  for (const auto& element : elements(wire.mesh_solids)) {
    LinkSolid solid;
    solid.link = read_text(element.link);
    const std::uint32_t kind = reader.enumerator("mesh_solids: shape", element.shape, kLastKind);
    solid.shape = to_shape({kind, {element.size[0], element.size[1], element.size[2]}});
    solid.T_link_shape = reader.pose("mesh_solids", element.pose);
    mesh_solids.solids.push_back(std::move(solid));
  }
  for (const auto& pair : elements(wire.unfiltered))
    mesh_solids.unfiltered.emplace_back(read_text(pair.first), read_text(pair.second));
  return mesh_solids;
}

}  // namespace

std::optional<Error> validate(const RobotDescription& description) {
  Rules rules;
  rules.name(check_label(description.label))
      .not_empty("urdf", description.urdf)
      .at_most("urdf (bytes)", description.urdf.size(), kMaxUrdfBytes)
      .text("urdf", description.urdf, kMaxUrdfBytes)
      .not_empty("base_link", description.base_link)
      .text("base_link", description.base_link, kMaxLinkNameBytes)
      .not_empty("tip_link", description.tip_link)
      .text("tip_link", description.tip_link, kMaxLinkNameBytes)
      .pose("T_tip_transfer", description.T_tip_transfer)
      .at_most("held_joints", description.held_joints.size(), kMaxHeldJoints)
      .at_most("never_colliding", description.never_colliding.size(), kMaxCollisionPairs);
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
  wire.label = arena.text(description.label);
  wire.urdf = arena.text(description.urdf);
  wire.base_link = arena.text(description.base_link);
  wire.tip_link = arena.text(description.tip_link);
  const PoseArray transfer = to_pose_array(description.T_tip_transfer);
  std::copy(transfer.begin(), transfer.end(), std::begin(wire.T_tip_transfer));
  std::copy(description.task_axes.matters.begin(), description.task_axes.matters.end(),
            std::begin(wire.task_axes));
  arena.resize(wire.held_joints, description.held_joints.size());
  std::size_t i = 0;
  for (const auto& [joint, position] : description.held_joints)
    wire.held_joints._buffer[i++] = {arena.text(joint), position};
  arena.resize(wire.never_colliding, description.never_colliding.size());
  i = 0;
  for (const auto& [first, second] : description.never_colliding)
    wire.never_colliding._buffer[i++] = {arena.text(first), arena.text(second)};
  write_mesh_solids(description.mesh_solids, arena, wire);
  return limited(std::move(message));
}

Result<RobotDescription> decode(const kinship_wire_RegisterRequest& wire) {
  Reader reader;
  RobotDescription description;
  description.label = read_text(wire.label);
  description.urdf = read_text(wire.urdf);
  description.base_link = read_text(wire.base_link);
  description.tip_link = read_text(wire.tip_link);
  description.T_tip_transfer = reader.pose("T_tip_transfer", wire.T_tip_transfer);
  std::copy(std::begin(wire.task_axes), std::end(wire.task_axes),
            description.task_axes.matters.begin());
  reader.rules.at_most("held_joints", wire.held_joints._length, kMaxHeldJoints)
      .at_most("never_colliding", wire.never_colliding._length, kMaxCollisionPairs);
  if (reader.rules.broken())
    return *reader.rules.broken();
  for (const auto& held : elements(wire.held_joints)) {
    const std::string joint = read_text(held.joint);
    if (!description.held_joints.emplace(joint, held.position).second)
      reader.rules.that(false, "held joint '" + joint + "': is there twice");
  }
  for (const auto& pair : elements(wire.never_colliding))
    description.never_colliding.emplace_back(read_text(pair.first), read_text(pair.second));
  description.mesh_solids = read_mesh_solids(wire, reader);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(description))
    return *error;
  return description;
}

Result<Message<kinship_wire_RegisterReply>> encode(const Head& head, const RegisterReply& reply) {
  return encode_fields(reply, Message<kinship_wire_RegisterReply>(head), validate);
}

Result<RegisterReply> decode(const kinship_wire_RegisterReply& wire) {
  return decode_fields<RegisterReply>(wire, validate);
}

}  // namespace kinship::codec
