#include "server/transfer/collision_filter.hpp"

#include <memory>

namespace kinship::transfer {

ConfigurationFilter collision_filter(const kinematics::Chain& robot,
                                     const geometry::RobotShapes& shapes,
                                     const collision::Surroundings& surroundings) {
  if (shapes.shapes.empty())
    return {};
  // Copies of the function share the world: it cannot be copied, and it is asked by one at a time.
  const auto world = std::make_shared<collision::CollisionWorld>(robot, shapes, surroundings);
  return [world](const Eigen::Ref<const Eigen::VectorXd>& q) { return !world->collides(q); };
}

}  // namespace kinship::transfer
