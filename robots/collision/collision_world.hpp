#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/scene.hpp"
#include "robots/collision/robot_solids.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// What surrounds a robot: scene and attached objects, and pairs of names that may touch.
struct Surroundings {
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  Scene scene;  ///< in the task frame
  std::vector<AttachedObject> attached;
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
};

/// A robot among obstacles that answers whether a configuration collides, and counts how often
/// it was asked. Not shared between threads.
class CollisionWorld {
 public:
  /// \throws Failure(InvalidInput) if an attached object or an allowed pair names what is not
  ///         there, a shape is not finite and positive, a pose not finite, or a mesh not read.
  CollisionWorld(const RobotSolids& robot, const Surroundings& surroundings);
  /// The same for a robot that has no other world.
  /// \throws Failure(InvalidInput) as above, and as RobotSolids says.
  CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                 const Surroundings& surroundings);
  CollisionWorld(CollisionWorld&&) noexcept;
  CollisionWorld& operator=(CollisionWorld&&) noexcept;
  ~CollisionWorld();

  /// Counts one check, whatever answers it.
  /// \param q  dof, joint units; limits are not checked.
  /// \throws std::invalid_argument if q has the wrong size or is not finite.
  bool collides(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Names of two things that touch at q, for messages; empty if none do. Counts no check.
  std::optional<std::pair<std::string, std::string>> find_contact(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Names of all pairs of things that touch at q. Counts no check.
  std::set<std::pair<std::string, std::string>> find_contacts(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  std::uint64_t checks() const noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::collision
