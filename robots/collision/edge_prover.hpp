#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/motion_bounds.hpp"

namespace kinship::collision {

/// The smallest clearance allowed, m: far above rounding, so that halving ends.
inline constexpr double kLeastClearance_m = 1e-5;

/// Largest clearance required between the robot's links and attachments, m: a wrist may pass its
/// hand by a few millimetres in every configuration, and both positions are known exactly.
inline constexpr double kOwnClearance_m = 1e-3;

struct EdgeProofOptions {
  /// A body nearer to an obstacle than this may count as touching, m, as may, up to
  /// kOwnClearance_m, a link nearer to another. Halving ends there: the smaller, the more
  /// configurations an edge along a surface costs.
  double clearance_m = 1e-3;
};

/// \throws Failure(InvalidInput) if a clearance is not from kLeastClearance_m to kLargestRoom_m.
/// \param name  of the argument, for the message
void check_clearance(const std::string& name, double clearance_m);

/// A place where an edge is not free.
struct EdgeRefutation {
  Eigen::VectorXd q;          ///< dof, joint units
  double share = 0;           ///< part of the edge before q, 0 to 1
  std::string first, second;  ///< the names of the bodies that touch there, or nearly do
  double clearance_m = 0;     ///< between the two: at most the one required
};

/// The result for the straight line between two configurations.
struct EdgeProof {
  std::optional<EdgeRefutation> refutation;  ///< none: no configuration of the edge touches
  /// Least distance measured between two bodies, at the checked configurations, m, to 1 % (of
  /// triangles and cubes and 0.1 mm). Between these the bodies may come nearer, but do not touch if
  /// the edge is free. Infinite if no pair was near enough to be measured.
  double least_clearance_m = 0;
  std::uint64_t configurations = 0;  ///< checked
  std::uint64_t distances = 0;       ///< measured, of a pair of bodies each

  bool is_free() const noexcept { return !refutation; }
};

/// Two bodies near enough to count as touching.
struct NearPair {
  std::string first, second;  ///< names
  double clearance_m = 0;     ///< between the two; 0: they touch
  double asked_m = 0;         ///< the one required; at least clearance_m
};

/// Proves that a robot touches nothing on the straight line between two configurations, or finds a
/// place where it does. Not shared between threads, and its world is not used at the same time;
/// repeated calls allocate only where they need more than earlier edges.
///
/// A pair of bodies is apart on a piece of the edge if their largest relative motion is less than
/// the sum of their distances at its ends, or than twice their distance at its middle. The world's
/// lanes test the latter, sixteen middles at a time, with bodies grown by that motion. For the
/// pairs left open, pieces are halved, the longest first, until none is left or a pair is as near
/// as `clearance_m`. Halving halves the motion, so it ends.
/// Source: Schwarzer, Saha and Latombe, Adaptive Dynamic Collision Checking for Single and Multiple
/// Articulated Robots in Complex Environments, IEEE Transactions on Robotics 21 (2005), section
/// III.
class EdgeProver {
 public:
  /// \param world  gives the pairs to check; must outlive this. Its count of checks does not
  ///               change.
  explicit EdgeProver(CollisionWorld& world);

  /// \param from, to  dof, joint units; limits are not checked, continuous joints turn from the one
  ///                  value to the other.
  /// \throws std::invalid_argument if a size is wrong or a value not finite
  /// \throws Failure(InvalidInput) as check_clearance(), or if a body may move by more than 10 km.
  EdgeProof prove(const Eigen::Ref<const Eigen::VectorXd>& from,
                  const Eigen::Ref<const Eigen::VectorXd>& to,
                  const EdgeProofOptions& options = {});

  /// The same for several edges, at less cost than one after the other.
  /// \param from, to  dof x n: an edge's ends, a column each
  /// \return one per edge, valid until the next call
  const std::vector<EdgeProof>& prove_all(const Eigen::Ref<const Eigen::MatrixXd>& from,
                                          const Eigen::Ref<const Eigen::MatrixXd>& to,
                                          const EdgeProofOptions& options = {});

  /// How many configurations, from the first on, keep the clearance before one does not.
  /// \param qs  dof x n, joint units
  /// \throws as above.
  Eigen::Index clear_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                           const EdgeProofOptions& options = {});

  /// The opposite: how many do not keep it before one does.
  Eigen::Index near_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                          const EdgeProofOptions& options = {});

  /// Whether all of some configurations keep the clearance: sooner than clear_ahead() where one
  /// does not, whichever it is.
  bool are_clear(const Eigen::Ref<const Eigen::MatrixXd>& qs, const EdgeProofOptions& options = {});

  /// All pairs that are too near at one configuration, for each pair of names the nearest, for
  /// messages; those of the last joints come first.
  /// \throws as above.
  std::vector<NearPair> find_near(const Eigen::Ref<const Eigen::VectorXd>& q,
                                  const EdgeProofOptions& options = {});

  /// Least distance of what moves from the obstacles at some configurations, m, as closely as
  /// EdgeProof has it; kLargestRoom_m if nothing is nearer.
  /// \param qs  dof x n, joint units
  /// \throws as above.
  double least_clearance_m(const Eigen::Ref<const Eigen::MatrixXd>& qs);

 private:
  /// The distance of a pair at a configuration, as far as it is known.
  struct Distance {
    double m = -1;  // lower bound; negative: unknown
    bool is_close = false;
  };
  /// A configuration of the edge, with the bodies and pairs computed so far.
  struct Place {
    std::size_t edge = 0;
    double share = 0;
    Eigen::VectorXd q;
    std::vector<Eigen::Isometry3d> T_base_joints, T_base_bodies;  // the latter of moving_
    Eigen::MatrixXd reach_m;                                      // moving joints x moving_
    std::vector<char> has_body;       // of moving_: whether it is placed and its reach measured
    std::vector<Distance> distances;  // one a pair
  };
  /// A part of the edge and the pairs that are open on it.
  struct Piece {
    std::size_t edge = 0;
    std::size_t from = 0, to = 0;      // places
    std::size_t first = 0, count = 0;  // of open_
  };
  /// A part of an edge, by shares of it.
  struct Part {
    std::size_t edge = 0;
    double from = 0, to = 0;
    std::size_t first = 0, count = 0;  // of doubts_: the pairs that are open on it; 0: all
  };

  /// Checks the arguments and sets the clearances.
  void begin(const Eigen::Ref<const Eigen::MatrixXd>& qs, const EdgeProofOptions& options);
  bool is_own(const BodyPair& pair) const;         ///< whether none of the two is an obstacle
  double clearance_m(const BodyPair& pair) const;  ///< required of a pair
  /// Checks the edges by the lanes, part by part; open parts become pieces.
  void ask_lanes();
  /// Checks at most kLanes parts. \param is_last  whether they are not cut into smaller ones
  void ask_parts(std::span<const Part> parts, bool is_last);
  /// The pairs that are open on some parts, each on those where it is; none: all.
  std::span<const LaneDoubt> pairs_of(std::span<const Part> parts);
  /// Cuts a part that the lanes leave open into smaller ones or makes it a piece; refutes the edge
  /// where bodies surely touch.
  void open_part(const Part& part, int lane, bool surely, bool is_last);
  /// Whether solids are too near at a place where, by the lanes, some touch.
  bool find_contact(std::size_t edge, double share);
  /// Opens the pairs that the lanes doubt. \return false: all of them.
  bool open_doubtful(int lane);
  /// The configuration at a share of an edge. \return its index.
  std::size_t add_place(std::size_t edge, double share);
  const Eigen::Isometry3d& pose_at(Place& place, std::size_t body);  ///< in the base frame
  /// The distance of a pair at a place, at least a cheap one.
  Distance& distance_at(Place& place, std::size_t pair);
  /// Bounds the motion of the bodies of a piece's pairs.
  void bound_motion(const Piece& piece);
  /// Whether a pair is apart all along a piece. Sets the refutation if it is too near at an end.
  bool is_apart(const Piece& piece, std::size_t pair);
  /// Measures a pair, closely up to `enough_m`. \return whether it keeps the clearance.
  bool measure(Place& place, std::size_t pair, double enough_m);
  /// How many, from the first on, keep the clearance, or do not, before one differs.
  Eigen::Index alike_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs, bool clear);
  /// Whether all pairs in doubt keep the clearance. \param lane  q's, of the last question
  bool is_clear(int lane, const Eigen::Ref<const Eigen::VectorXd>& q);
  /// Moves the bodies of a pair to the world's poses of joints.
  void place(const BodyPair& pair);
  /// Distance of a pair at the world's poses, close if it may be too near.
  double placed_distance_m(const BodyPair& pair) const;
  void look_at(Piece piece);  ///< by value: the list grows

  CollisionWorld& world_;
  std::vector<BodyPair>
      pairs_;  // sorted; the first of each is moved by the earlier joint, or stands
  std::vector<int> joints_before_both_;  // of each pair: the last that moves both, or -1
  MotionBounds bounds_;
  std::vector<std::size_t> moving_;   // the bodies that joints move
  std::vector<int> index_of_moving_;  // one a body: of moving_, or -1

  // Of the edges of the present call.
  Eigen::MatrixXd from_, change_;  // dof x n
  LaneRoom clearances_;
  std::vector<EdgeProof> proofs_;
  std::deque<Place> places_;
  std::size_t used_places_ = 0;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> open_;          // pairs
  std::vector<Part> parts_, rest_;         // checked by the lanes, now and next
  std::vector<LaneDoubt> doubts_, asked_;  // pairs open on parts; those of a question
  Eigen::MatrixXd motion_m_;               // moving joints + 1 x bodies: of a piece
  Eigen::MatrixXd middles_, changes_;      // dof x kLanes: of parts; from there to their ends
  std::vector<BodyPair> doubtful_;
  std::vector<std::uint64_t> body_stamps_;
  std::uint64_t stamp_ = 0;
};

}  // namespace kinship::collision
