#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "handles.hpp"
#include "moveit_versions.hpp"

namespace kinship_moveit {

/// A planning scene as libkinship takes it: obstacles with their shapes, attached bodies, and the
/// pairs that the allowed collision matrix always allows. An object of several shapes becomes one
/// object each, id/1, id/2 and so on. Owns what its structures point to.
class SceneObjects {
 public:
  /// \param state         of the query's start, up to date.
  /// \param tip_link      of the planned chain.
  /// \param T_tip_transfer  of the transfer frame.
  /// \param T_task_world  pose of the planning frame in the task's frame.
  SceneObjects(const planning_scene::PlanningScene& scene, const moveit::core::RobotState& state,
               const std::string& tip_link, const Eigen::Isometry3d& T_tip_transfer,
               const Eigen::Isometry3d& T_task_world);
  SceneObjects(const SceneObjects&) = delete;
  SceneObjects& operator=(const SceneObjects&) = delete;

  const std::vector<kinship_object>& objects() const { return objects_; }
  /// Two names a pair, of links and objects.
  const std::vector<const char*>& allowed() const { return allowed_; }
  /// The same without pairs that name a link.
  const std::vector<const char*>& allowed_objects() const { return allowed_objects_; }
  /// What the scene has and libkinship cannot be told, e.g. a body on a link that does not move
  /// with the tip; empty: nothing.
  const std::string& untold() const { return untold_; }

 private:
  using Parts = std::vector<const char*>;  // names

  /// One shape of the object `id`. \param name  its own.
  void add(const std::string& id, const std::string& name, const shapes::Shape& shape,
           const Eigen::Isometry3d& T, bool is_held);
  void add_points(std::vector<double> points, kinship_object& object);
  void allow_pairs(const planning_scene::PlanningScene& scene,
                   const std::vector<const moveit::core::AttachedBody*>& attached);
  /// Each of the first with each of the second.
  void allow(const Parts& first, const Parts& second, bool are_objects);

  std::deque<std::string> names_;
  std::map<std::string, Parts> parts_;  // of each object that libkinship is told of
  std::deque<std::vector<double>> points_;
  std::vector<kinship_object> objects_;
  std::vector<const char*> allowed_, allowed_objects_;
  std::string untold_;
};

}  // namespace kinship_moveit
