#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robots/collision/body_pairs.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/motion_bounds.hpp"

namespace kinship::collision {

/// The smallest clearance that may be asked for, m: far above rounding, so that halving ends.
inline constexpr double kLeastClearance_m = 1e-5;

/// Clearance of the robot's links, and what it holds, from one another, m, where less is not asked
/// for: a wrist may pass its hand by a few millimetres wherever it goes, and knows where both are.
inline constexpr double kOwnClearance_m = 1e-3;

struct EdgeProofOptions {
  /// What comes nearer to an obstacle than this may count as touching, m, and, up to
  /// kOwnClearance_m, what comes nearer to another link. Halving ends there: the smaller, the more
  /// configurations an edge along a surface costs.
  double clearance_m = 1e-3;
};

/// \throws Failure(InvalidInput) if a clearance is not from kLeastClearance_m to kLargestRoom_m.
/// \param name  of the argument, for the message
void check_clearance(const std::string& name, double clearance_m);

/// Where an edge is not free.
struct EdgeRefutation {
  Eigen::VectorXd q;          ///< dof, joint units
  double share = 0;           ///< of the edge before q, 0 to 1
  std::string first, second;  ///< the names of what touches there, or nearly does
  double clearance_m = 0;     ///< between the two: at most what is asked of them
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

/// Two things that are as near to each other as may count as touching.
struct NearPair {
  std::string first, second;  ///< names
  double clearance_m = 0;     ///< between the two; 0: they touch
  double asked_m = 0;         ///< that is asked of them; at least clearance_m
};

/// Proves that a robot touches nothing on the straight line between two configurations, or finds
/// where it does. Not shared between threads, and its world is not asked at the same time; asking
/// again needs no heap but for what an earlier edge did not.
///
/// A pair of bodies is apart on a piece of the edge if what they can move relative to each other is
/// less than the sum of their distances at its ends, or than twice their distance at its middle.
/// The latter is asked of the world's lanes, sixteen middles at a time, of bodies grown by that
/// motion. Of the pairs that this leaves open pieces are halved, the longest first, until none is
/// left or a pair is as near as `clearance_m`. Halving halves the motion, so it ends.
/// Source: Schwarzer, Saha and Latombe, Adaptive Dynamic Collision Checking for Single and Multiple
/// Articulated Robots in Complex Environments, IEEE Transactions on Robotics 21 (2005), section
/// III.
class EdgeProver {
 public:
  /// \param world  whose pairs are looked at; must outlive this. Its checks are not counted.
  explicit EdgeProver(CollisionWorld& world);

  /// \param from, to  dof, joint units; limits are not checked, continuous joints turn the way
  ///                  their numbers say.
  /// \throws std::invalid_argument if a size is wrong or a value not finite
  /// \throws Failure(InvalidInput) as check_clearance(), or if a body may move by more than 10 km.
  EdgeProof prove(const Eigen::Ref<const Eigen::VectorXd>& from,
                  const Eigen::Ref<const Eigen::VectorXd>& to,
                  const EdgeProofOptions& options = {});

  /// The same of several edges, which costs less than one after the other.
  /// \param from, to  dof x n: an edge's ends, a column each
  /// \return one an edge, until this is asked again
  const std::vector<EdgeProof>& prove_all(const Eigen::Ref<const Eigen::MatrixXd>& from,
                                          const Eigen::Ref<const Eigen::MatrixXd>& to,
                                          const EdgeProofOptions& options = {});

  /// How many configurations, from the first on, are farther than the clearance from touching
  /// anything, before one is not.
  /// \param qs  dof x n, joint units
  /// \throws as above.
  Eigen::Index clear_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                           const EdgeProofOptions& options = {});

  /// The same the other way round: how many are not, before one is.
  Eigen::Index near_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                          const EdgeProofOptions& options = {});

  /// All pairs that are too near at one configuration, of each pair of names the nearest, for
  /// messages; those of the last joints come first.
  /// \throws as above.
  std::vector<NearPair> find_near(const Eigen::Ref<const Eigen::VectorXd>& q,
                                  const EdgeProofOptions& options = {});

 private:
  /// What is known of a pair at a configuration.
  struct Distance {
    double m = -1;  // from below; negative: not looked at
    bool is_close = false;
  };
  /// A configuration of the edge; of bodies and pairs what was asked for.
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
  };

  /// Checks what is asked and takes over the clearances.
  void begin(const Eigen::Ref<const Eigen::MatrixXd>& qs, const EdgeProofOptions& options);
  double clearance_m(const BodyPair& pair) const;  ///< that is asked of a pair
  /// Asks the lanes about the edges, part by part; what they leave open becomes pieces.
  void ask_lanes();
  /// Asks about at most kLanes parts. \param is_last  whether they are not cut into smaller ones
  void ask_parts(std::span<const Part> parts, bool is_last);
  /// What is to become of a part that the lanes leave open, or where bodies surely touch.
  void open_part(const Part& part, int lane, bool surely, bool is_last);
  /// Whether solids are too near where the lanes say that some touch.
  bool find_contact(std::size_t edge, double share);
  /// Opens the pairs that the lanes doubt. \return false: all of them.
  bool open_doubtful(int lane);
  /// The configuration at a share of an edge. \return its index.
  std::size_t add_place(std::size_t edge, double share);
  const Eigen::Isometry3d& pose_at(Place& place, std::size_t body);  ///< in the base frame
  /// What is known of a pair at a place, a cheap distance at least.
  Distance& distance_at(Place& place, std::size_t pair);
  /// Bounds the motion of the bodies of a piece's pairs.
  void bound_motion(const Piece& piece);
  /// Whether a pair is apart all along a piece. Sets the refutation if it is too near at an end.
  bool is_apart(const Piece& piece, std::size_t pair);
  /// Measures a pair, closely unless it reaches what is enough. \return whether it is not too near.
  bool measure(Place& place, std::size_t pair, double enough_m);
  /// How many, from the first on, are clear, or not, before one answers otherwise.
  Eigen::Index alike_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs, bool clear);
  /// Whether no pair that the lanes doubt is too near. \param lane  q's, of the last question
  bool is_clear(int lane, const Eigen::Ref<const Eigen::VectorXd>& q);
  /// Of a pair where the world placed it, close where it may be too near.
  double placed_distance_m(const BodyPair& pair) const;
  void look_at(Piece piece);  ///< by value: the list grows

  CollisionWorld& world_;
  std::vector<BodyPair>
      pairs_;  // sorted; the first of each is moved by the earlier joint, or stands
  std::vector<int> joints_before_both_;  // of each pair: the last that moves both, or -1
  MotionBounds bounds_;
  std::vector<std::size_t> moving_;   // the bodies that joints move
  std::vector<int> index_of_moving_;  // one a body: of moving_, or -1

  // Of the edges that are asked about.
  Eigen::MatrixXd from_, change_;  // dof x n
  LaneRoom clearances_;
  std::vector<EdgeProof> proofs_;
  std::deque<Place> places_;
  std::size_t used_places_ = 0;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> open_;                // pairs
  std::vector<Part> parts_, rest_;               // that the lanes are asked about, now and next
  std::vector<Eigen::MatrixXd> edge_motions_m_;  // of each whole edge, by MotionBounds::bound_all
  Eigen::MatrixXd motion_m_, grown_m_;  // moving joints + 1 x bodies: of a piece, of a part
  Eigen::MatrixXd middles_;             // dof x kLanes
  std::vector<BodyPair> doubtful_;
  std::vector<std::uint64_t> body_stamps_;
  std::uint64_t stamp_ = 0;
};

}  // namespace kinship::collision
