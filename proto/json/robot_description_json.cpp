#include "proto/json/robot_description_json.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "proto/json/name_pairs_json.hpp"
#include "proto/json/parts.hpp"
#include "proto/json/reader.hpp"
#include "proto/json/scene_json.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::json {
namespace {

TaskAxes read_axes(const Reader& reader) {
  std::vector<std::string> words;
  for (const Reader& element : reader.elements(kTaskAxisNames.size()))
    words.push_back(element.text(kMaxLabelBytes));
  const auto axes = parse_task_axes({words.begin(), words.end()});
  if (!axes)
    reader.refuse(axes.error().message);
  return *axes;
}

MeshSolids read_mesh_solids(const Reader& reader) {
  reader.allow_only({"solids", "unfiltered"});
  MeshSolids mesh_solids;
  for (const Reader& each : reader.at("solids").elements(kMaxMeshSolids)) {
    each.allow_only({"link", "shape", "T_link_shape"});
    mesh_solids.solids.push_back({each.at("link").text(kMaxLinkNameBytes),
                                  read_shape(each.at("shape")), each.at("T_link_shape").pose()});
  }
  mesh_solids.unfiltered = read_pairs(reader.at("unfiltered"));
  if (const auto error = check_mesh_solids(mesh_solids))
    throw Failure(*error);
  return mesh_solids;
}

OrderedJson mesh_solids_object(const MeshSolids& mesh_solids) {
  OrderedJson object;
  object["solids"] = OrderedJson::array();
  for (const LinkSolid& solid : mesh_solids.solids) {
    OrderedJson entry;
    entry["link"] = solid.link;
    entry["shape"] = shape_object(solid.shape);
    entry["T_link_shape"] = pose_list(solid.T_link_shape);
    object["solids"].push_back(std::move(entry));
  }
  object["unfiltered"] = pair_list(mesh_solids.unfiltered);
  return object;
}

std::vector<LinkMesh> read_meshes(const Reader& reader) {
  std::vector<LinkMesh> meshes;
  for (const Reader& each : reader.elements(kMaxLinkMeshes)) {
    each.allow_only({"link", "role", "T_link_mesh", "rgba", "error_m", "content"});
    LinkMesh mesh;
    mesh.link = each.at("link").text(kMaxLinkNameBytes);
    mesh.role = parse_word<MeshRole>(each.at("role").text(kMaxWordBytes)).value_or_throw();
    mesh.T_link_mesh = each.at("T_link_mesh").pose();
    if (const auto rgba = each.find("rgba"))
      for (const Reader& part : rgba->elements(4))
        mesh.rgba.push_back(part.number(0, 1));
    if (const auto error = each.find("error_m"))
      mesh.error_m = error->number(0, kMaxPlacement_m);
    mesh.content = each.at("content").digest();
    meshes.push_back(std::move(mesh));
  }
  if (const auto error = check_link_meshes(meshes))
    throw Failure(*error);
  return meshes;
}

OrderedJson mesh_list(const std::vector<LinkMesh>& meshes) {
  OrderedJson list = OrderedJson::array();
  for (const LinkMesh& mesh : meshes) {
    OrderedJson entry;
    entry["link"] = mesh.link;
    entry["role"] = to_text(mesh.role);
    entry["T_link_mesh"] = pose_list(mesh.T_link_mesh);
    if (!mesh.rgba.empty())
      entry["rgba"] = mesh.rgba;
    if (mesh.error_m > 0)
      entry["error_m"] = mesh.error_m;
    entry["content"] = mesh.content.hex();
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace

RobotDescription read_robot_description(const Reader& reader) {
  RobotDescription description;
  description.label = reader.at("label").text(kMaxLabelBytes);
  if (const auto error = check_label(description.label))
    throw Failure(*error);
  description.urdf = reader.at("urdf").text(kMaxUrdfBytes);
  description.base_link = reader.at("base_link").text(kMaxLinkNameBytes);
  description.tip_link = reader.at("tip_link").text(kMaxLinkNameBytes);
  if (const auto transfer = reader.find("T_tip_transfer"))
    description.T_tip_transfer = transfer->pose();
  if (const auto axes = reader.find("task_axes"))
    description.task_axes = read_axes(*axes);
  if (const auto held = reader.find("held_joints"))
    for (const std::string& joint : held->keys(kMaxHeldJoints)) {
      if (joint.empty() || joint.size() > kMaxLinkNameBytes)
        held->refuse("a joint name has " + std::to_string(joint.size()) + " bytes, must be 1 to " +
                     std::to_string(kMaxLinkNameBytes));
      description.held_joints[joint] = held->at(joint).number();
    }
  if (const auto pairs = reader.find("never_colliding"))
    description.never_colliding = read_pairs(*pairs);
  if (const auto mesh_solids = reader.find("mesh_solids"))
    description.mesh_solids = read_mesh_solids(*mesh_solids);
  if (const auto meshes = reader.find("meshes"))
    description.meshes = read_meshes(*meshes);
  return description;
}

OrderedJson robot_description_object(const RobotDescription& description) {
  OrderedJson object;
  object["label"] = description.label;
  object["urdf"] = description.urdf;
  object["base_link"] = description.base_link;
  object["tip_link"] = description.tip_link;
  object["T_tip_transfer"] = pose_list(description.T_tip_transfer);
  OrderedJson axes = OrderedJson::array();
  for (std::size_t i = 0; i < kTaskAxisNames.size(); ++i)
    if (description.task_axes.matters[i])
      axes.push_back(kTaskAxisNames[i]);
  object["task_axes"] = std::move(axes);
  object["held_joints"] = OrderedJson::object();
  for (const auto& [joint, value] : description.held_joints)
    object["held_joints"][joint] = value;
  object["never_colliding"] = pair_list(description.never_colliding);
  if (!description.mesh_solids.solids.empty())
    object["mesh_solids"] = mesh_solids_object(description.mesh_solids);
  if (!description.meshes.empty())
    object["meshes"] = mesh_list(description.meshes);
  return object;
}

std::string to_json(const RobotDescription& description) {
  return write(kRobotDescriptionFormat, robot_description_object(description));
}

Result<RobotDescription> robot_description_from_json(std::string_view text) {
  return read_document(text, "robot description", kRobotDescriptionFormat, read_robot_description);
}

}  // namespace kinship::json
