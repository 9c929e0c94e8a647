#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>

#include "proto/types/digest.hpp"
#include "proto/types/robot_description.hpp"
#include "server/store/store.hpp"

namespace kinship::sites {

/// Takes over a description whose geometry is better than what is known of its robot; by the rule
/// of who registers a robot again (RobotRegistry). \return whether it was better.
using TakeGeometry = std::function<bool(const Digest& robot, const RobotDescription& description)>;

/// Brings the better geometry of robots to whichever of two stores has a worse one. Where both are
/// as good each keeps its own, so what is better spreads and nothing goes to and fro.
class GeometryExchange {
 public:
  /// \param here, above  outlive it.
  GeometryExchange(store::Store& here, store::Store& above, TakeGeometry take_here,
                   TakeGeometry take_above);

  /// A robot that both have by now: compared once.
  void compare_new(const Digest& robot);

  /// Those where either of both took better geometry over since they were compared.
  void compare_changed();

 private:
  /// How often better geometry was taken over: here, above.
  using Revisions = std::pair<std::uint64_t, std::uint64_t>;

  void compare(const Digest& robot);

  store::Store& here_;
  store::Store& above_;
  const TakeGeometry take_here_, take_above_;
  std::map<Digest, Revisions> compared_;
};

}  // namespace kinship::sites
