#include "server/fitting/target_memory.hpp"

namespace kinship::fitting {

TargetMemory::Target TargetMemory::find(const runtime::Robot& robot) {
  {
    const std::lock_guard lock(mutex_);
    const Known* const known = known_.find(robot.digest);
    if (known != nullptr && known->geometry_revision == robot.geometry_revision)
      return known->target;
  }
  const auto target =
      std::make_shared<const transfer::TargetRobot>(robot.chain, robot.shapes, robot.covers.get());
  const std::lock_guard lock(mutex_);
  known_.put(robot.digest, {robot.geometry_revision, target}, 1);
  while (known_.size() > max_robots_)
    known_.drop_oldest();
  return target;
}

std::size_t TargetMemory::size() const {
  const std::lock_guard lock(mutex_);
  return known_.size();
}

}  // namespace kinship::fitting
