#include "client/moveit/objects.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <string_view>

#include "client/moveit/geometry_messages.hpp"

namespace kinship::moveit {
namespace {

/// A collision object's parts by the name that the scene gives it.
using PartNames = std::map<std::string, std::vector<std::string>>;

/// One solid or mesh of a collision object.
struct Part {
  std::string name;
  std::optional<Shape> solid;  ///< or else the mesh
  Mesh mesh;
  Eigen::Isometry3d T_frame_part;  ///< in the frame of the object's header
};

void refuse_what_is_there(const YamlValue& list, const std::string& why) {
  if (!list.items().empty())
    list.refuse(why);
}

/// The pose beside an element of a list.
Eigen::Isometry3d pose_beside(const YamlValue& object, const char* poses, std::size_t index) {
  const std::vector<YamlValue> all = object[poses].items();
  if (index >= all.size())
    object[poses].refuse(std::to_string(all.size()) + " poses, fewer than there are shapes");
  return read_pose(all[index]);
}

/// A mesh of triangles, which becomes a file, or one that is a file already (benchmark sets).
Mesh take_mesh(const YamlValue& value, const std::string& name, std::vector<MeshFile>& files) {
  if (const YamlValue resource = value["resource"]; !resource.is_missing()) {
    const YamlValue scale = value.first_of({"scale", "dimensions"});
    return {.file = resource.text(),
            .scale =
                scale.is_missing() ? Eigen::Vector3d(Eigen::Vector3d::Ones()) : read_vector(scale)};
  }
  std::string file = name + ".obj";
  std::ranges::replace(file, '/', '_');
  files.push_back({.name = file, .obj = read_mesh(value)});
  return {.file = file};
}

/// CollisionObject.operation by number, by word, and as ros2 topic echo writes a byte: itself, or
/// in base 64.
void require_addition(const YamlValue& operation) {
  using Names = std::array<std::string_view, 4>;
  static constexpr std::array<Names, 4> kOperations = {
      {{"0", "add", std::string_view("\0", 1), "AA=="},
       {"1", "remove", "\x01", "AQ=="},
       {"2", "append", "\x02", "Ag=="},
       {"3", "move", "\x03", "Aw=="}}};
  const std::string said = operation.text_or("0");
  const auto found = std::ranges::find_if(
      kOperations, [&](const Names& names) { return std::ranges::count(names, said) > 0; });
  if (found == kOperations.begin())
    return;
  const std::string name = found == kOperations.end()
                               ? said
                               : std::string((*found)[0]) + ", " + std::string((*found)[1]);
  operation.refuse("'" + name +
                   "' is a change to another scene; 0 (add) is expected, as in what "
                   "/get_planning_scene answers");
}

/// moveit_msgs/CollisionObject
std::vector<Part> read_parts(const YamlValue& object, std::vector<MeshFile>& files) {
  const std::string id = object["id"].text();
  require_addition(object["operation"]);
  refuse_what_is_there(object["planes"], "planes are not known; make '" + id + "' a box");
  const std::vector<YamlValue> solids = object["primitives"].items();
  const std::vector<YamlValue> meshes = object["meshes"].items();
  const std::size_t count = solids.size() + meshes.size();
  if (count == 0)
    object.refuse("'" + id + "' has neither primitives nor meshes");
  const Eigen::Isometry3d T_frame_object = read_pose(object["pose"]);
  std::vector<Part> parts;
  const auto next_name = [&] {
    return count == 1 ? id : id + "/" + std::to_string(parts.size() + 1);
  };
  for (std::size_t index = 0; index < solids.size(); ++index)
    parts.push_back(
        {.name = next_name(),
         .solid = read_solid(solids[index]),
         .mesh = {},
         .T_frame_part = T_frame_object * pose_beside(object, "primitive_poses", index)});
  for (std::size_t index = 0; index < meshes.size(); ++index)
    parts.push_back({.name = next_name(),
                     .solid = std::nullopt,
                     .mesh = take_mesh(meshes[index], next_name(), files),
                     .T_frame_part = T_frame_object * pose_beside(object, "mesh_poses", index)});
  return parts;
}

void note_names(const YamlValue& object, const std::vector<Part>& parts, PartNames& names) {
  std::vector<std::string>& of_object = names[object["id"].text()];
  if (!of_object.empty())
    object["id"].refuse("'" + object["id"].text() + "' is there twice");
  for (const Part& part : parts)
    of_object.push_back(part.name);
}

void read_world(const YamlValue& world, const Frames& frames, Conversion& conversion,
                PartNames& names) {
  refuse_what_is_there(
      world["octomap"]["octomap"]["data"],
      "an octomap cannot be taken from here; save it (octomap_saver) and name the file among the "
      "problem's clouds");
  for (const YamlValue& object : world["collision_objects"].items()) {
    const Eigen::Isometry3d T_task_frame = frames.T_task_header(object);
    const std::vector<Part> parts = read_parts(object, conversion.meshes);
    note_names(object, parts, names);
    Scene& scene = conversion.problem.scene;
    for (const Part& part : parts) {
      const Eigen::Isometry3d T_task_part = T_task_frame * part.T_frame_part;
      if (part.solid)
        scene.objects.push_back(
            {.name = part.name, .shape = *part.solid, .T_task_object = T_task_part});
      else
        scene.meshes.push_back({.name = part.name, .mesh = part.mesh, .T_task_mesh = T_task_part});
    }
  }
}

/// moveit_msgs/AttachedCollisionObject
void read_attached(const YamlValue& attached, const kinematics::Chain& chain, const Frames& frames,
                   Conversion& conversion, PartNames& names) {
  const YamlValue object = attached["object"];
  const Eigen::Isometry3d T_link_frame =
      frames.T_task_link(attached["link_name"]).inverse() * frames.T_task_header(object);
  const std::vector<Part> parts = read_parts(object, conversion.meshes);
  note_names(object, parts, names);
  std::vector<std::string> touch_links;
  for (const YamlValue& link : attached["touch_links"].items())
    if (chain.find_link(link.text()) >= 0)
      touch_links.push_back(link.text());
    else
      conversion.left_out.push_back("'" + link.text() + "' may touch '" + object["id"].text() +
                                    "', but the robot has no such link");
  for (const Part& part : parts) {
    AttachedObject held = {.name = part.name,
                           .link = attached["link_name"].text(),
                           .shape = part.solid.value_or(Shape()),
                           .T_link_object = T_link_frame * part.T_frame_part,
                           .touch_links = touch_links};
    if (!part.solid)
      held.mesh = part.mesh;
    conversion.problem.attached.push_back(std::move(held));
  }
}

/// An entry's row, which benchmark sets write without a member around it.
std::vector<YamlValue> row_items(const YamlValue& row) {
  return row.is_map() ? row["enabled"].items() : row.items();
}

using NamePair = std::pair<std::string, std::string>;  // in order

NamePair pair_of(const std::string& first, const std::string& second) {
  return std::minmax(first, second);
}

/// The matrix's values for pairs of its entries.
std::map<NamePair, bool> read_matrix(const YamlValue& matrix) {
  const std::vector<YamlValue> entries = matrix["entry_names"].items();
  const std::vector<YamlValue> rows = matrix["entry_values"].items();
  if (rows.size() != entries.size())
    matrix["entry_values"].refuse(std::to_string(rows.size()) + " rows of " +
                                  std::to_string(entries.size()) + " entries");
  std::map<NamePair, bool> said;
  for (std::size_t first = 0; first < rows.size(); ++first) {
    const std::vector<YamlValue> row = row_items(rows[first]);
    if (row.size() != entries.size())
      rows[first].refuse(std::to_string(row.size()) + " values of " +
                         std::to_string(entries.size()) + " entries");
    for (std::size_t second = first + 1; second < row.size(); ++second)
      said[pair_of(entries[first].text(), entries[second].text())] = row[second].flag();
  }
  return said;
}

std::map<std::string, bool> read_defaults(const YamlValue& matrix) {
  const std::vector<YamlValue> names = matrix["default_entry_names"].items();
  const std::vector<YamlValue> values = matrix["default_entry_values"].items();
  if (values.size() != names.size())
    matrix["default_entry_values"].refuse(std::to_string(values.size()) + " values of " +
                                          std::to_string(names.size()) + " entries");
  std::map<std::string, bool> defaults;
  for (std::size_t index = 0; index < names.size(); ++index)
    defaults[names[index].text()] = values[index].flag();
  return defaults;
}

/// moveit_msgs/AllowedCollisionMatrix: its value for a pair counts, else both their defaults.
/// Entries of links and objects that are not here are left.
void read_allowed(const YamlValue& matrix, const kinematics::Chain& chain, const PartNames& names,
                  Conversion& conversion) {
  std::map<std::string, std::vector<std::string>> bodies(names);
  for (const auto& link : chain.links())
    bodies.try_emplace(link.name, std::vector{link.name});
  const std::map<NamePair, bool> said = read_matrix(matrix);
  const std::map<std::string, bool> defaults = read_defaults(matrix);
  const auto is_allowed = [&](const std::string& first, const std::string& second) {
    if (const auto known = said.find(pair_of(first, second)); known != said.end())
      return known->second;
    const auto of_first = defaults.find(first), of_second = defaults.find(second);
    const bool is_known = of_first != defaults.end() || of_second != defaults.end();
    return is_known && (of_first == defaults.end() || of_first->second) &&
           (of_second == defaults.end() || of_second->second);
  };
  for (auto first = bodies.begin(); first != bodies.end(); ++first)
    for (auto second = std::next(first); second != bodies.end(); ++second)
      if (is_allowed(first->first, second->first))
        for (const std::string& a : first->second)
          for (const std::string& b : second->second)
            conversion.problem.allowed_collisions.emplace_back(a, b);
}

bool is_padded(const YamlValue& list, const char* member, double neutral) {
  const std::vector<YamlValue> items = list.items();
  return std::ranges::any_of(
      items, [&](const YamlValue& item) { return item[member].number_or(neutral) != neutral; });
}

/// A state that by itself gives the held objects: it has joints, and calls itself no difference.
bool is_whole_state(const YamlValue& state) {
  const YamlValue difference = state["is_diff"];
  return !difference.is_missing() && !difference.flag() &&
         !state["joint_state"]["name"].items().empty();
}

}  // namespace

void read_objects(const YamlValue& scene, const YamlValue& request, const kinematics::Chain& chain,
                  const Frames& frames, Conversion& conversion) {
  PartNames names;
  read_world(scene["world"], frames, conversion, names);
  const YamlValue start = request["start_state"];
  for (const YamlValue& attached : start["attached_collision_objects"].items())
    read_attached(attached, chain, frames, conversion, names);
  for (const YamlValue& attached : scene["robot_state"]["attached_collision_objects"].items()) {
    const std::string id = attached["object"]["id"].text();
    if (is_whole_state(start) && !names.contains(id))
      conversion.left_out.push_back("'" + id +
                                    "', attached in the scene: the start state is no change to "
                                    "that (is_diff: false) and does not hold it");
    else if (!names.contains(id))  // a start state often repeats them
      read_attached(attached, chain, frames, conversion, names);
  }
  read_allowed(scene["allowed_collision_matrix"], chain, names, conversion);
  if (is_padded(scene["link_padding"], "padding", 0) || is_padded(scene["link_scale"], "scale", 1))
    conversion.left_out.push_back("padding and scale of links");
}

}  // namespace kinship::moveit
