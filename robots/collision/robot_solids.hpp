#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/body_pairs.hpp"

namespace kinship::collision {

/// What all worlds of one robot have in common, made once: the solids of its links, for meshes
/// their trees of triangles, and the pairs of links that are checked. Immutable, cheap to copy, may
/// be shared between threads.
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
    LinkPairs always_touching;  ///< of these, those found in random configurations
  };
  const Parts& parts() const noexcept { return *parts_; }

 private:
  std::shared_ptr<const Parts> parts_;
};

/// Names the pairs of links that are not checked because they touch wherever the robot goes, and
/// says what to do: a sentence without a full stop at its end; empty if there are none.
std::string describe_always_touching(const RobotSolids& robot);

/// The links of a robot and what surrounds it.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor says.
std::vector<Body> bodies_among(const RobotSolids& robot, const Surroundings& surroundings);

}  // namespace kinship::collision
