#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>

#include "proto/types/digest.hpp"
#include "proto/types/robot_description.hpp"
#include "server/store/robot_store.hpp"

namespace kinship::sites {

/// Takes over a description whose geometry is better than the known one of its robot, by the rule
/// for a repeated registration (RobotRegistry). \return whether it was better.
using TakeGeometry = std::function<bool(const Digest& robot, const RobotDescription& description)>;

/// Copies the better geometry of a robot, with the contents of its meshes, to the one of two stores
/// that has a worse one. If both are
/// equally good each keeps its own, so better geometry spreads and none goes to and fro.
class GeometryExchange {
 public:
  /// \param here, above  outlive it.
  GeometryExchange(store::RobotStore& here, store::RobotStore& above, TakeGeometry take_here,
                   TakeGeometry take_above);

  /// Compares a robot that both stores have, once.
  void compare_new(const Digest& robot);

  /// Compares robots of which either store took over better geometry since the last comparison.
  void compare_changed();

 private:
  /// Number of times better geometry was taken over: here, above.
  using Revisions = std::pair<std::uint64_t, std::uint64_t>;

  void compare(const Digest& robot);

  store::RobotStore& here_;
  store::RobotStore& above_;
  const TakeGeometry take_here_, take_above_;
  std::map<Digest, Revisions> compared_;
};

}  // namespace kinship::sites
