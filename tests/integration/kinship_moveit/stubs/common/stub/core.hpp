#pragma once

#include <geometric_shapes/shapes.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <rclcpp/rclcpp.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stub/messages.hpp"

/// What client/ros2/kinship_moveit uses of moveit_core in every release, with the least behind it
/// that behaves: a model of one chain whose kinematics and validity the test brings.
namespace moveit::core {

struct VariableBounds {
  double min_position_ = 0, max_position_ = 0;
  bool position_bounded_ = true;
};

class LinkModel {
 public:
  LinkModel(std::string name, const LinkModel* rigid_parent)
      : name_(std::move(name)), rigid_parent_(rigid_parent) {}
  const std::string& getName() const { return name_; }
  const LinkModel* rigid_parent() const { return rigid_parent_ ? rigid_parent_ : this; }

 private:
  std::string name_;
  const LinkModel* rigid_parent_;  // null: none
};

class JointModel {
 public:
  explicit JointModel(const LinkModel* parent) : parent_(parent) {}
  const LinkModel* getParentLinkModel() const { return parent_; }

 private:
  const LinkModel* parent_;
};

class JointModelGroup {
 public:
  std::string name;
  std::vector<std::string> variables, links;
  std::vector<const JointModel*> joints;
  bool is_chain = true;

  const std::string& getName() const { return name; }
  bool isChain() const { return is_chain; }
  const std::vector<std::string>& getVariableNames() const { return variables; }
  unsigned int getVariableCount() const { return static_cast<unsigned int>(variables.size()); }
  const std::vector<std::string>& getLinkModelNames() const { return links; }
  const std::vector<const JointModel*>& getJointModels() const { return joints; }
};

class RobotModel {
 public:
  std::string name;
  std::map<std::string, JointModelGroup> groups;
  std::map<std::string, LinkModel> link_models;
  std::vector<std::string> links_with_geometry;
  std::map<std::string, VariableBounds> bounds;
  /// Of a link in the model's frame.
  std::function<Eigen::Isometry3d(const std::string&, const Eigen::VectorXd&)> kinematics;

  const std::string& getName() const { return name; }
  bool hasJointModelGroup(const std::string& group) const { return groups.count(group) != 0; }
  const JointModelGroup* getJointModelGroup(const std::string& group) const {
    const auto found = groups.find(group);
    return found == groups.end() ? nullptr : &found->second;
  }
  const LinkModel* getLinkModel(const std::string& link) const {
    const auto found = link_models.find(link);
    return found == link_models.end() ? nullptr : &found->second;
  }
  const std::string& getRootLinkName() const { return link_models.begin()->first; }
  const std::vector<std::string>& getLinkModelNamesWithCollisionGeometry() const {
    return links_with_geometry;
  }
  const VariableBounds& getVariableBounds(const std::string& variable) const {
    return bounds.at(variable);
  }
  static const LinkModel* getRigidlyConnectedParentLinkModel(const LinkModel* link) {
    return link->rigid_parent();
  }
};
using RobotModelConstPtr = std::shared_ptr<const RobotModel>;

class AttachedBody {
 public:
  std::string name;
  const LinkModel* link = nullptr;
  std::vector<shapes::ShapeConstPtr> shapes;
  std::vector<Eigen::Isometry3d> T_link_shapes, T_world_shapes;
  std::set<std::string> touch_links;

  const std::string& getName() const { return name; }
  const std::string& getAttachedLinkName() const { return link->getName(); }
  const LinkModel* getAttachedLink() const { return link; }
  const std::vector<shapes::ShapeConstPtr>& getShapes() const { return shapes; }
  const std::vector<Eigen::Isometry3d>& getGlobalCollisionBodyTransforms() const {
    return T_world_shapes;
  }
  const std::set<std::string>& getTouchLinks() const { return touch_links; }
};

class RobotState {
 public:
  explicit RobotState(RobotModelConstPtr model, Eigen::Index dof)
      : model_(std::move(model)), q(Eigen::VectorXd::Zero(dof)) {}

  void setJointGroupPositions(const JointModelGroup* group, const double* values) {
    q = Eigen::Map<const Eigen::VectorXd>(values, group->getVariableCount());
  }
  void copyJointGroupPositions(const JointModelGroup* group, double* values) const {
    std::copy_n(q.data(), group->getVariableCount(), values);
  }
  void update(bool = false) {
    for (AttachedBody& body : attached) {
      body.T_world_shapes.clear();
      for (const auto& T : body.T_link_shapes)
        body.T_world_shapes.push_back(getGlobalLinkTransform(body.link->getName()) * T);
    }
  }
  Eigen::Isometry3d getGlobalLinkTransform(const std::string& link) const {
    return model_->kinematics(link, q);
  }
  void getAttachedBodies(std::vector<const AttachedBody*>& bodies) const {
    for (const AttachedBody& body : attached)
      bodies.push_back(&body);
  }
  void setToRandomPositions(const JointModelGroup* group) {
    static thread_local std::mt19937_64 generator(1);
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const auto& range = model_->getVariableBounds(group->variables[static_cast<std::size_t>(i)]);
      q[i] = std::uniform_real_distribution<double>(range.min_position_,
                                                    range.max_position_)(generator);
    }
  }
  bool satisfiesBounds(const JointModelGroup* group, double = 0) const {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const auto& range = model_->getVariableBounds(group->variables[static_cast<std::size_t>(i)]);
      if (q[i] < range.min_position_ || q[i] > range.max_position_)
        return false;
    }
    return true;
  }

 private:
  RobotModelConstPtr model_;

 public:
  Eigen::VectorXd q;
  std::vector<AttachedBody> attached;
};
using RobotStatePtr = std::shared_ptr<RobotState>;
using GroupStateValidityCallbackFn =
    std::function<bool(RobotState*, const JointModelGroup*, const double*)>;

}  // namespace moveit::core

namespace collision_detection {

namespace AllowedCollision {
enum Type { NEVER, ALWAYS, CONDITIONAL };
}

class AllowedCollisionMatrix {
 public:
  std::map<std::pair<std::string, std::string>, AllowedCollision::Type> entries;
  bool getAllowedCollision(const std::string& a, const std::string& b,
                           AllowedCollision::Type& type) const {
    const auto found = entries.find(std::minmax(a, b));
    if (found != entries.end())
      type = found->second;
    return found != entries.end();
  }
};

class World {
 public:
  struct Object {
    std::vector<shapes::ShapeConstPtr> shapes_;
    std::vector<Eigen::Isometry3d> global_shape_poses_;
  };
  std::map<std::string, std::shared_ptr<const Object>> objects;
  std::vector<std::string> getObjectIds() const {
    std::vector<std::string> ids;
    for (const auto& [id, object] : objects)
      ids.push_back(id);
    return ids;
  }
  std::shared_ptr<const Object> getObject(const std::string& id) const { return objects.at(id); }
};

}  // namespace collision_detection

namespace robot_trajectory {

class RobotTrajectory {
 public:
  RobotTrajectory(moveit::core::RobotModelConstPtr model, const std::string& group)
      : model_(std::move(model)), group_(model_->getJointModelGroup(group)) {}
  RobotTrajectory& addSuffixWayPoint(const moveit::core::RobotState& state, double) {
    states_.push_back(state);
    return *this;
  }
  std::size_t getWayPointCount() const { return states_.size(); }
  const moveit::core::RobotState& getWayPoint(std::size_t i) const { return states_.at(i); }
  const moveit::core::JointModelGroup* getGroup() const { return group_; }

 private:
  moveit::core::RobotModelConstPtr model_;
  const moveit::core::JointModelGroup* group_;
  std::vector<moveit::core::RobotState> states_;
};
using RobotTrajectoryPtr = std::shared_ptr<RobotTrajectory>;

}  // namespace robot_trajectory

namespace planning_scene {

class PlanningScene {
 public:
  PlanningScene(moveit::core::RobotModelConstPtr its_model, moveit::core::RobotState its_state)
      : model(std::move(its_model)), state(std::move(its_state)) {}
  moveit::core::RobotModelConstPtr model;
  moveit::core::RobotState state;
  std::shared_ptr<collision_detection::World> world =
      std::make_shared<collision_detection::World>();
  collision_detection::AllowedCollisionMatrix matrix;
  std::string planning_frame = "world";
  std::map<std::string, Eigen::Isometry3d> frames;
  std::function<bool(const moveit::core::RobotState&)> is_valid;

  const moveit::core::RobotModelConstPtr& getRobotModel() const { return model; }
  moveit::core::RobotStatePtr getCurrentStateUpdated(const moveit_msgs::msg::RobotState&) const {
    return std::make_shared<moveit::core::RobotState>(state);
  }
  const std::string& getPlanningFrame() const { return planning_frame; }
  std::shared_ptr<const collision_detection::World> getWorld() const { return world; }
  const collision_detection::AllowedCollisionMatrix& getAllowedCollisionMatrix() const {
    return matrix;
  }
  Eigen::Isometry3d getFrameTransform(const moveit::core::RobotState&,
                                      const std::string& id) const {
    const auto found = frames.find(id);
    return found == frames.end() ? Eigen::Isometry3d::Identity() : found->second;
  }
  bool isStateValid(const moveit::core::RobotState& asked, const moveit_msgs::msg::Constraints&,
                    const std::string&, bool = false) const {
    return is_valid(asked);
  }
  bool isPathValid(const robot_trajectory::RobotTrajectory& path,
                   const moveit_msgs::msg::Constraints&,
                   const std::vector<moveit_msgs::msg::Constraints>& goals, const std::string&,
                   bool = false, std::vector<std::size_t>* = nullptr) const {
    for (std::size_t i = 0; i < path.getWayPointCount(); ++i)
      if (!is_valid(path.getWayPoint(i)))
        return false;
    const moveit::core::RobotState& last = path.getWayPoint(path.getWayPointCount() - 1);
    for (const auto& goal : goals)
      if (is_met(goal, last, *path.getGroup()))
        return true;
    return goals.empty();
  }

 private:
  bool is_met(const moveit_msgs::msg::Constraints& goal, const moveit::core::RobotState& last,
              const moveit::core::JointModelGroup& group) const {
    for (const auto& joint : goal.joint_constraints)
      for (std::size_t i = 0; i < group.variables.size(); ++i)
        if (group.variables[i] == joint.joint_name &&
            std::abs(last.q[static_cast<Eigen::Index>(i)] - joint.position) > 1e-3)
          return false;
    for (const auto& position : goal.position_constraints) {
      const auto& at = position.constraint_region.primitive_poses.front().position;
      if ((last.getGlobalLinkTransform(position.link_name).translation() -
           Eigen::Vector3d(at.x, at.y, at.z))
              .norm() > 1e-3)
        return false;
    }
    return true;
  }
};
using PlanningSceneConstPtr = std::shared_ptr<const PlanningScene>;

}  // namespace planning_scene
