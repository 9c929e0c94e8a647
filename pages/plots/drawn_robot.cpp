#include "pages/plots/drawn_robot.hpp"

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "pages/page/json_text.hpp"
#include "proto/types/base64.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/pose.hpp"
#include "robots/geometry/known_shapes.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::plots {
namespace {

using page::json_string;
using page::list;
using page::number;
using page::object;

std::string pose(const Eigen::Isometry3d& T) { return list(to_pose_array(T), number); }

std::string_view type_of(const kinematics::Joint& joint) {
  switch (joint.type) {
    case kinematics::JointType::Prismatic:
      return "prismatic";
    case kinematics::JointType::Continuous:
      return "continuous";
    default:
      return "revolute";
  }
}

std::string json_of(const kinematics::Joint& joint) {
  const bool is_length = joint.type == kinematics::JointType::Prismatic;
  return object({{"name", json_string(joint.name)},
                 {"type", json_string(type_of(joint))},
                 {"unit", json_string(is_length ? "m" : "rad")},
                 {"T_previous_joint", pose(joint.T_previous_joint)},
                 {"axis", list(joint.axis, number)},
                 {"lower", number(joint.lower)},
                 {"upper", number(joint.upper)}});
}

std::string json_of(const kinematics::MimicJoint& mimic) {
  return object({{"joint", json_of(mimic.joint)},
                 {"before", std::to_string(mimic.before)},
                 {"source", std::to_string(mimic.source)},
                 {"multiplier", number(mimic.multiplier)},
                 {"offset", number(mimic.offset)}});
}

/// Links with their solids; `pose` of a solid is T_link_solid.
std::string links_of(const models::LoadedRobot& robot, const geometry::RobotShapes& shown) {
  std::vector<std::vector<SceneObject>> solids(robot.chain.links().size());
  for (const geometry::LinkShape& each : shown.shapes)
    solids.at(static_cast<std::size_t>(each.link))
        .push_back({robot.chain.links()[static_cast<std::size_t>(each.link)].name, each.shape,
                    each.T_link_shape, each.approximate});
  std::size_t next = 0;
  return list(robot.chain.links(), [&](const kinematics::ChainLink& link) {
    return object({{"name", json_string(link.name)},
                   {"joint", std::to_string(link.joint)},
                   {"T_joint_link", pose(link.T_joint_link)},
                   {"solids", page::json_of(solids[next++])}});
  });
}

/// Those whose contents are here.
std::string meshes_of(const DrawnRobot& drawn) {
  std::vector<const LinkMesh*> shown;
  for (const LinkMesh& mesh : drawn.robot.description.meshes)
    if (drawn.contents.contains(mesh.content))
      shown.push_back(&mesh);
  return list(shown, [&](const LinkMesh* mesh) {
    return object({{"link", std::to_string(drawn.robot.chain.find_link(mesh->link))},
                   {"role", json_string(to_text(mesh->role))},
                   {"pose", pose(mesh->T_link_mesh)},
                   {"rgba", list(mesh->rgba, number)},
                   {"error_m", number(mesh->error_m)},
                   {"content", json_string(mesh->content.hex())}});
  });
}

std::string contents_of(const DrawnRobot& drawn) {
  std::string json;
  for (const auto& [digest, bytes] : drawn.contents)
    json += (json.empty() ? "" : ",") + json_string(digest.hex()) + ":" + json_string(bytes);
  return "{" + json + "}";
}

}  // namespace

DrawnRobot drawn_robot(const RobotDescription& description,
                       const std::vector<StoredMesh>& contents) {
  kinematics::RobotModel robot = kinematics::read_model(description).value_or_throw();
  std::map<Digest, MeshContent> found;
  for (const StoredMesh& mesh : contents)
    if (auto zlib = from_base64(mesh.zlib))
      found[mesh.content] = {static_cast<std::uint32_t>(mesh.bytes), *std::move(zlib)};
  geometry::FindMesh find;
  if (!found.empty())
    find = [&](const Digest& content) {
      const auto here = found.find(content);
      return here == found.end() ? std::nullopt : std::optional(here->second);
    };
  geometry::KnownShapes known = geometry::read_known_shapes(robot, find).value_or_throw();
  geometry::RobotShapes solids = known.mesh_links > 0
                                     ? geometry::read_known_shapes(robot).value_or_throw().shapes
                                     : known.shapes;
  std::string shapes = geometry::describe(known);
  DrawnRobot drawn{
      {std::move(robot), std::move(known.shapes)}, std::move(solids), {}, std::move(shapes)};
  for (const auto& [digest, content] : found)
    if (const auto mesh = TriangleMesh::read(content))
      drawn.contents.emplace(digest, to_base64(mesh->canonical()));
  return drawn;
}

std::string to_json(const DrawnRobot& drawn) {
  const kinematics::Chain& chain = drawn.robot.chain;
  return object({{"label", json_string(drawn.robot.description.label)},
                 {"digest", json_string(chain.digest().hex())},
                 {"base_link", json_string(chain.base_link())},
                 {"tip_link", json_string(chain.tip_link())},
                 {"joints", list(chain.joints(),
                                 [](const kinematics::Joint& each) { return json_of(each); })},
                 {"mimics", list(chain.mimics(),
                                 [](const kinematics::MimicJoint& each) { return json_of(each); })},
                 {"links", links_of(drawn.robot, drawn.solids)},
                 {"meshes", meshes_of(drawn)},
                 {"contents", contents_of(drawn)},
                 {"T_last_tip", pose(chain.T_last_tip())},
                 {"T_tip_transfer", pose(chain.T_tip_transfer())},
                 {"shapes", json_string(drawn.shapes)}});
}

}  // namespace kinship::plots
