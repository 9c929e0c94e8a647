#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/body_pairs.hpp"
#include "robots/collision/motion_bounds.hpp"
#include "robots/collision/robot_solids.hpp"

namespace kinship::collision {

struct EdgeProofOptions {
  /// What comes nearer than this may count as touching, m. Halving ends there: the smaller, the
  /// more configurations an edge along a surface costs.
  double clearance_m = 1e-3;
};

/// Where an edge is not free.
struct EdgeRefutation {
  Eigen::VectorXd q;          ///< dof, joint units
  double share = 0;           ///< of the edge before q, 0 to 1
  std::string first, second;  ///< the names of what touches there, or nearly does
  double clearance_m = 0;     ///< between the two: at most EdgeProofOptions::clearance_m
};

/// What is known of the straight line between two configurations.
struct EdgeProof {
  std::optional<EdgeRefutation> refutation;  ///< none: no configuration of the edge touches
  /// Least distance that was measured between two bodies, at the configurations looked at, m, to
  /// 1 % (of triangles and cubes and 0.1 mm). Between them the bodies may come nearer, but do not
  /// touch if the edge is free. Infinite where no pair came so near that it had to be measured.
  double least_clearance_m = 0;
  std::uint64_t configurations = 0;  ///< looked at
  std::uint64_t distances = 0;       ///< measured, of a pair of bodies each

  bool is_free() const noexcept { return !refutation; }
};

/// Proves that a robot touches nothing on the straight line between two configurations, or finds
/// where it does. The same pairs as CollisionWorld's of the same arguments. Not shared between
/// threads; asking again needs no heap but for what an earlier edge did not.
///
/// A pair of bodies is apart on a piece of the edge if what they can move relative to each other is
/// less than the sum of their distances at its ends. Pieces are halved for the pairs that this
/// leaves open, the longest first, until none is left or a pair is as near as `clearance_m`.
/// Halving halves the motion, so it ends. Source: Schwarzer, Saha and Latombe, Adaptive Dynamic
/// Collision Checking for Single and Multiple Articulated Robots in Complex Environments, IEEE
/// Transactions on Robotics 21 (2005), section III.
class EdgeProver {
 public:
  /// \throws Failure(InvalidInput) as CollisionWorld's constructor.
  EdgeProver(const RobotSolids& robot, const Surroundings& surroundings);
  EdgeProver(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
             const Surroundings& surroundings);

  /// \param from, to  dof, joint units; limits are not checked, continuous joints turn the way
  /// their
  ///                  numbers say.
  /// \throws std::invalid_argument if a size is wrong, a value not finite, or clearance_m not in
  ///         (0, 1].
  EdgeProof prove(const Eigen::Ref<const Eigen::VectorXd>& from,
                  const Eigen::Ref<const Eigen::VectorXd>& to,
                  const EdgeProofOptions& options = {});

 private:
  /// What is known of a pair at a configuration.
  struct Distance {
    double m = 0;  // from below
    bool is_close = false;
  };
  /// A configuration of the edge; of bodies and pairs what is asked for.
  struct Place {
    double share = 0;
    Eigen::VectorXd q;
    std::vector<Eigen::Isometry3d> T_base_joints, T_base_bodies;
    Eigen::MatrixXd reach_m;          // moving joints x bodies
    std::vector<Distance> distances;  // one a pair
  };
  /// A part of the edge and the pairs that are open on it.
  struct Piece {
    std::size_t from = 0, to = 0;      // places
    std::size_t first = 0, count = 0;  // of open_
  };

  void check(const Eigen::Ref<const Eigen::VectorXd>& from,
             const Eigen::Ref<const Eigen::VectorXd>& to, const EdgeProofOptions& options) const;
  /// Adds the configuration at a share of the edge, with cheap distances of the pairs that are
  /// open. \return its index.
  std::size_t add_place(double share, std::size_t first, std::size_t count);
  /// Bounds the motion of the bodies of a piece's pairs.
  void bound_motion(const Piece& piece);
  /// Whether a pair is apart all along a piece. Sets the refutation if it is too near at an end.
  bool is_apart(const Piece& piece, std::size_t pair);
  /// Measures a pair, closely unless it reaches what is enough. \return whether it is not too near.
  bool measure(Place& place, std::size_t pair, double enough_m);
  void look_at(Piece piece);  ///< by value: the list grows

  RobotSolids robot_;
  std::vector<Body> bodies_;
  std::vector<BodyPair> pairs_;  // the first of each is moved by the earlier joint, or stands
  std::vector<int> joints_before_both_;  // of each pair: the last that moves both, or -1
  std::optional<BodyPair> standing_contact_;
  MotionBounds bounds_;

  // Of the edge that is asked about.
  Eigen::VectorXd from_, change_;
  double clearance_m_ = 0;
  EdgeProof proof_;
  std::deque<Place> places_;
  std::size_t used_places_ = 0;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> open_;  // pairs
  Eigen::MatrixXd motion_m_;       // moving joints + 1 x bodies
  std::vector<std::uint64_t> body_stamps_;
  std::uint64_t stamp_ = 0;
};

}  // namespace kinship::collision
