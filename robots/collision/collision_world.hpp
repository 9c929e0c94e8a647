#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/scene.hpp"
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
  /// Links that touch in each of many random configurations are never checked (see README), nor
  /// are links joined by one moving or by fixed joints.
  /// \throws Failure(InvalidInput) if an attached object names an unknown link or a shape is not
  ///         finite and positive.
  CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                 const Surroundings& surroundings);
  ~CollisionWorld();

  /// Counts one check, whatever answers it.
  bool collides(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Names of two things that touch at q, for messages; empty if none do. Counts no check.
  std::optional<std::pair<std::string, std::string>> find_contact(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  std::uint64_t checks() const noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::collision
