#include "pages/plots/drawn_robot.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "pages/page/json_text.hpp"
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
std::string links_of(const models::LoadedRobot& robot) {
  std::vector<std::vector<SceneObject>> solids(robot.chain.links().size());
  for (const geometry::LinkShape& each : robot.shapes.shapes)
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

}  // namespace

DrawnRobot drawn_robot(const RobotDescription& description) {
  kinematics::RobotModel robot = kinematics::read_model(description).value_or_throw();
  geometry::KnownShapes known = geometry::read_known_shapes(robot).value_or_throw();
  std::string shapes = geometry::describe(known);
  return {{std::move(robot), std::move(known.shapes)}, std::move(shapes)};
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
                 {"links", links_of(drawn.robot)},
                 {"T_last_tip", pose(chain.T_last_tip())},
                 {"T_tip_transfer", pose(chain.T_tip_transfer())},
                 {"shapes", json_string(drawn.shapes)}});
}

}  // namespace kinship::plots
