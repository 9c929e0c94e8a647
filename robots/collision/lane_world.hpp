#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/collision/distance_grid.hpp"
#include "robots/collision/lanes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// Largest growth of pairs besides their motion, m: the pairs that come so near are determined
/// once.
inline constexpr double kLargestRoom_m = 0.1;

/// The result for some configurations; bit i: the i-th.
struct LaneAnswer {
  std::uint32_t maybe = 0;   ///< may collide; the others are free for sure
  std::uint32_t surely = 0;  ///< collides for sure; a part of maybe
};

/// Growth of pairs besides their motion, m.
struct LaneRoom {
  double standing_m = 0;  ///< of a moving and a standing body
  double moving_m = 0;    ///< of two moving bodies
};

/// The moving bodies of a world as spheres, and the standing ones as boxes, capsules and cylinders;
/// checks several configurations at once. Never reports touching solids as free. Not shared between
/// threads.
class LaneWorld {
 public:
  /// \param pairs  that are checked, one of each moves.
  LaneWorld(const kinematics::Chain& chain, const std::vector<Body>& bodies,
            const std::vector<BodyPair>& pairs);

  /// Asks with the fastest set.
  /// \param qs     dof x n, 1 <= n <= kLanes, finite; limits are not checked.
  /// \param scope  in other lanes the answer is undefined.
  LaneAnswer ask(const Eigen::Ref<const Eigen::MatrixXd>& qs, LaneScope scope = LaneScope::Each);

  /// The same of all lanes, with one of lane_sets().
  LaneAnswer ask(const Eigen::Ref<const Eigen::MatrixXd>& qs, const LaneSet& set);

  /// The same as the first for grown bodies that may also move: bodies that may not collide have so
  /// much room in every configuration of which no joint differs by more. Bodies that surely collide
  /// do so without either.
  /// \param changes  dof x n, of each configuration's joints, joint units, of either sign; or
  ///                 empty: none.
  /// \param room     growth of pairs.
  /// \param only     these pairs alone are looked at, each in its lanes, kLaneDoubts at most;
  /// empty:
  ///                 all.
  LaneAnswer ask_grown(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                       const Eigen::Ref<const Eigen::MatrixXd>& changes, const LaneRoom& room,
                       LaneScope scope, std::span<const LaneDoubt> only = {});

  /// Whether the lanes have room for the robot; else everything may collide.
  bool has_room() const noexcept { return has_room_; }

  /// Pairs that may touch at one configuration of the last call, if that does not surely collide.
  /// \param pairs  of the constructor's bodies.
  /// \return whether they are known; else each may.
  bool doubtful_pairs(int lane, std::vector<BodyPair>& pairs);

  /// The same to ask about again: adds those of one configuration.
  bool add_doubts(int lane, std::vector<LaneDoubt>& doubts) const;

 private:
  /// The conversion of a configuration for the kernels, joint by joint.
  struct alignas(16) Writing {
    double lower[kLaneJoints], upper[kLaneJoints];  // so that the numbers hold: of what slides its
                                                    // limits, of an angle what is exact after turns
    double offset[kLaneJoints];                     // added to an angle
    double per_turn[kLaneJoints];                   // 1 / 2 pi; 0 of what slides
  };
  /// A joint that follows one of the chain.
  struct Mimic {
    std::size_t source;
    double multiplier, offset;
  };
  struct alignas(64) Place {
    float values[kLanes];
  };

  friend class LaneWorldMaker;

  /// Writes a configuration into a lane of the question.
  /// \param q  dof, finite.
  /// \return whether its values are within the bounds of Writing.
  bool write_lane(const double* q, int lane);
  /// Writes configurations into the question, idle lanes as the last one.
  /// \return the configurations with values beyond the bounds of Writing.
  std::uint32_t write_question(const Eigen::Ref<const Eigen::MatrixXd>& qs);
  void write_changes(const Eigen::Ref<const Eigen::MatrixXd>& changes);
  LaneAnswer answer(const Eigen::Ref<const Eigen::MatrixXd>& qs, const LaneSet& set,
                    LaneScope scope);

  float slack_ = 0;
  Writing writing_{};
  std::vector<LaneJoint> joints_;  // of the chain, then the mimic joints
  std::vector<Mimic> mimics_;
  std::vector<LaneLink> links_;
  std::vector<LaneBody> bodies_;
  std::vector<LaneObstacle> obstacles_;
  std::vector<float> bounds_;
  std::vector<unsigned> reach_;
  std::vector<LaneSphere> spheres_;
  std::vector<float> cover_;
  std::vector<LaneLinkPair> link_pairs_;
  std::vector<LaneOther> others_;
  std::vector<std::size_t> index_of_body_, index_of_obstacle_;  // of the constructor's bodies
  DistanceGrid grid_;                                           // of a point cloud
  std::vector<Place> places_;                                   // kPlaceRows a sphere
  LaneQuestion question_;          // kept, so that asking needs no heap
  std::vector<LaneDoubt> doubts_;  // of one lane
  std::uint32_t beyond_ = 0;       // lanes that the numbers do not hold for
  bool has_room_ = true;           // for all joints and bodies; else everything may collide
};

/// Whether a rotation maps axes to axes: a box turned by it is a box along the axes again.
bool is_of_quarter_turns(const Eigen::Matrix3d& R);

/// The axes along which most of some boxes lie, among the axes of the first few; the identity for
/// none.
/// \param axes  of each box, one per column.
Eigen::Matrix3d common_axes(const std::vector<Eigen::Matrix3d>& axes);

}  // namespace kinship::collision
