#include "server/transfer/collision_filter.hpp"

#include <memory>

namespace kinship::transfer {

ConfigurationFilter collision_filter(const collision::RobotSolids& robot,
                                     const collision::Surroundings& surroundings) {
  if (robot.parts().bodies.empty())
    return {};
  // Copies of the function share the world: it cannot be copied, and it is asked by one at a time.
  const auto world = std::make_shared<collision::CollisionWorld>(robot, surroundings);
  return [world](const Eigen::Ref<const Eigen::MatrixXd>& qs) { return world->free_ahead(qs); };
}

}  // namespace kinship::transfer
