#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>

#include "server/fitting/last_used.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/transfer/target_robot.hpp"

namespace kinship::fitting {

/// Cache of target robots prepared for transfers, kept between fits: a new placement needs no new
/// preparation. Evicts the least recently used. May be shared between threads; no lock is held
/// while one is prepared.
class TargetMemory {
 public:
  using Target = std::shared_ptr<const transfer::TargetRobot>;

  /// About 0.1 MB each.
  static constexpr std::size_t kDefaultRobots = 64;

  explicit TargetMemory(std::size_t max_robots = kDefaultRobots) : max_robots_(max_robots) {}

  /// The robot, prepared with its current geometry.
  /// \throws Failure(InvalidInput), see collision::RobotSolids.
  Target find(const runtime::Robot& robot);

  std::size_t size() const;  ///< robots in memory

 private:
  struct Known {
    std::uint64_t geometry_revision = 0;
    Target target;
  };

  const std::size_t max_robots_;
  mutable std::mutex mutex_;  // guards what follows
  LastUsed<Known> known_;     // by robot
};

}  // namespace kinship::fitting
