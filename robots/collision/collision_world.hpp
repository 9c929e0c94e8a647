#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/body_pairs.hpp"
#include "robots/collision/robot_solids.hpp"

namespace kinship::collision {

/// A robot among obstacles that answers whether a configuration collides, and counts how often
/// it was asked. Not shared between threads.
class CollisionWorld {
 public:
  /// \throws Failure(InvalidInput) if an attached object or an allowed pair names what is not
  ///         there, a shape is not finite and positive, a pose not finite, or a mesh not read.
  CollisionWorld(const RobotSolids& robot, const Surroundings& surroundings);
  /// The same for a robot that has no other world.
  /// \throws Failure(InvalidInput) as above, and as RobotSolids says.
  CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                 const Surroundings& surroundings);
  CollisionWorld(const CollisionWorld&) = delete;  // it counts, and is asked by one at a time
  CollisionWorld& operator=(const CollisionWorld&) = delete;
  CollisionWorld(CollisionWorld&&) noexcept = default;
  CollisionWorld& operator=(CollisionWorld&&) noexcept = default;
  ~CollisionWorld() = default;

  /// Counts one check, whatever answers it.
  /// \param q  dof, joint units; limits are not checked.
  /// \throws std::invalid_argument if q has the wrong size or is not finite.
  bool collides(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Names of two things that touch at q, for messages; empty if none do. Counts no check.
  std::optional<std::pair<std::string, std::string>> find_contact(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Names of all pairs of things that touch at q. Counts no check.
  std::set<std::pair<std::string, std::string>> find_contacts(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  std::uint64_t checks() const noexcept { return checks_; }

 private:
  /// Moves the bodies to q.
  void place(const Eigen::Ref<const Eigen::VectorXd>& q);
  std::optional<BodyPair> first_contact(const Eigen::Ref<const Eigen::VectorXd>& q);
  bool touching(const BodyPair& pair) const;
  std::pair<std::string, std::string> names(const BodyPair& pair) const;

  RobotSolids robot_;
  std::vector<Body> bodies_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;  // one per body; moving ones change per check
  std::vector<BodyPair> pairs_;
  std::vector<BodyPair> standing_contacts_;  // each makes every configuration collide
  std::uint64_t checks_ = 0;
};

}  // namespace kinship::collision
