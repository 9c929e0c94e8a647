#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robots/collision/body.hpp"

namespace kinship::collision {

/// The common part of all worlds of one robot, made once: the solids of its links, for meshes their
/// trees of triangles, and the pairs of links that are checked. Immutable, cheap to copy, may be
/// shared between threads.
class RobotSolids {
 public:
  /// Never checked: links fixed to each other, neighbouring links, the shapes' never-colliding
  /// pairs and, if there are none of these, links that touch in at least 95 % of 200 random
  /// configurations (seeded: equal input, equal answers).
  /// \throws Failure(InvalidInput) if a shape is not finite and positive, or a pose not finite.
  RobotSolids(const kinematics::Chain& chain, const geometry::RobotShapes& shapes);

  struct Parts {
    kinematics::Chain chain;
    std::vector<Body> bodies;  ///< of the links
    LinkPairs unchecked;
    LinkPairs always_touching;      ///< of these, the ones found in random configurations
    std::vector<BodyPair> checked;  ///< checked_links()
  };
  const Parts& parts() const noexcept { return *parts_; }

 private:
  std::shared_ptr<const Parts> parts_;
};

/// A sentence, without a full stop, on the pairs of links that are not checked because they always
/// touch, with advice; empty if there are none.
std::string describe_always_touching(const RobotSolids& robot);

/// The bodies of a robot's links and its surroundings.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor.
std::vector<Body> bodies_among(const RobotSolids& robot, const Surroundings& surroundings);

}  // namespace kinship::collision
