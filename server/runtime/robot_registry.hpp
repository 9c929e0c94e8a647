#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"
#include "server/store/store.hpp"

namespace kinship::runtime {

/// A robot that the service can compute with.
struct Robot {
  Digest digest;
  std::string label;
  kinematics::Chain chain;
  /// Without the URDF's meshes; nothing if the URDF's geometry cannot be read.
  geometry::RobotShapes shapes = {};
};

/// Knows the robots of a store and keeps their chains in memory once they were parsed. May be
/// shared between threads; no lock is held while it parses or reads the store.
class RobotRegistry {
 public:
  /// The registry and whoever computes with the robot share it: it never changes.
  using RobotPointer = std::shared_ptr<const Robot>;

  /// \param store  outlives the registry.
  explicit RobotRegistry(store::Store& store) : store_(store) {}

  /// Parses, identifies and stores a robot, and tells which other robots of the store are the same
  /// arm: at most kMaxSameArms labels, in their order, none if the store cannot tell. Refused, with
  /// the reason, if the description breaks a rule or its label belongs to another robot.
  ///
  /// The first call after a start reads every robot of the store; later ones find them in memory.
  /// \param now_ms  Unix time, UTC.
  /// \throws Failure(Storage)
  RegisterReply register_robot(const RobotDescription& description, std::int64_t now_ms);

  /// From memory, or read from the store and parsed.
  /// \return NotFound if the store has no such robot; InvalidInput if its description cannot be
  ///         read any more; Storage if its row is damaged or the store cannot be read.
  Result<RobotPointer> find(const Digest& robot);

  /// From memory only; null if it is not there.
  RobotPointer find_in_memory(const Digest& robot) const;

 private:
  RobotPointer keep(Robot robot);
  std::vector<std::string> same_arms(const Digest& robot, const kinematics::Chain& chain);

  store::Store& store_;
  mutable std::mutex mutex_;  // guards robots_
  std::map<Digest, RobotPointer> robots_;
};

}  // namespace kinship::runtime
