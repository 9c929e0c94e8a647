#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/lane_world.hpp"
#include "robots/collision/robot_solids.hpp"

namespace kinship::collision {

/// A robot among obstacles: checks configurations for collisions, and counts the checks. Not shared
/// between threads.
class CollisionWorld {
 public:
  /// \throws Failure(InvalidInput) if an attached object or an allowed pair has an unknown name, a
  ///         shape is not finite and positive, a pose not finite, or a mesh not read.
  CollisionWorld(const RobotSolids& robot, const Surroundings& surroundings);
  /// The same for a robot that has no other world.
  /// \throws Failure(InvalidInput) as above, and as RobotSolids.
  CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                 const Surroundings& surroundings);
  CollisionWorld(const CollisionWorld&) = delete;  // it counts, and has one user at a time
  CollisionWorld& operator=(const CollisionWorld&) = delete;
  CollisionWorld(CollisionWorld&&) noexcept = default;
  CollisionWorld& operator=(CollisionWorld&&) noexcept = default;
  ~CollisionWorld() = default;

  /// Whether q collides. Counts one check, whichever test decides.
  /// \param q  dof, joint units; limits are not checked.
  /// \throws std::invalid_argument if q has the wrong size or is not finite.
  bool collides(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// How many configurations, from the first on, are free before one collides. Checks several at
  /// once; counts a check for each of the free ones and for the one that collides, as if checked
  /// one after the other.
  /// \param qs  dof x n, joint units
  /// \throws std::invalid_argument as collides().
  Eigen::Index free_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs);

  /// The same the other way round: how many collide before one is free, which is counted too.
  Eigen::Index colliding_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs);

  /// Names of two bodies that touch at q, for messages; empty if none do. Counts no check.
  std::optional<std::pair<std::string, std::string>> find_contact(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Names of all pairs of bodies that touch at q. Counts no check.
  std::set<std::pair<std::string, std::string>> find_contacts(
      const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Two bodies and a lower bound of their distance, as close as Solid's; 0: they touch.
  struct NearestPair {
    std::string first, second;
    double distance_m = 0;
  };
  /// Of the checked pairs that joints move, the nearest with an obstacle and the nearest without
  /// one. None where no such pair is checked.
  struct NearestPairs {
    std::optional<NearestPair> obstacle, own;
  };

  /// The nearest pairs at q. Counts no check.
  NearestPairs find_nearest(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// A body wholly within a closed mesh, which no check notices.
  struct Enclosed {
    std::string inner, mesh;  ///< names of links, attachments, obstacles
    bool operator==(const Enclosed&) const = default;
  };

  /// The bodies of the robot wholly within an obstacle's mesh at q, and the obstacles within the
  /// mesh of a link or an attachment; each pair of names once. Only pairs that are checked, except
  /// of two links. Counts no check.
  std::vector<Enclosed> find_enclosed(const Eigen::Ref<const Eigen::VectorXd>& q);

  std::uint64_t checks() const noexcept { return checks_; }

 private:
  friend class EdgeProver;  // looks at the same pairs, and asks the same lanes

  /// How many, from the first on, have the same answer before one differs.
  Eigen::Index alike_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs, bool colliding);
  /// Whether a pair that the lanes could not decide touches. \param lane  q's, of the last
  /// question.
  bool touches_in_doubt(int lane, const Eigen::Ref<const Eigen::VectorXd>& q);
  /// Moves the bodies to q.
  void place(const Eigen::Ref<const Eigen::VectorXd>& q);
  std::optional<BodyPair> first_contact(const Eigen::Ref<const Eigen::VectorXd>& q);
  bool touching(const BodyPair& pair) const;
  std::pair<std::string, std::string> names(const BodyPair& pair) const;

  RobotSolids robot_;
  std::vector<Body> bodies_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;  // one per body; moving ones change per check
  std::vector<BodyPair> pairs_;
  std::vector<BodyPair> standing_pairs_;
  std::vector<BodyPair> standing_contacts_;  // each makes every configuration collide
  LaneWorld lanes_;
  std::vector<BodyPair> doubtful_;  // kept, like the next ones, so that a check allocates nothing
  std::vector<Eigen::Isometry3d> T_base_joints_;
  std::uint64_t checks_ = 0;
};

}  // namespace kinship::collision
