#pragma once

#include <cstdint>
#include <span>
#include <string_view>

// Included by the units that are compiled for one instruction set: nothing here may bring inline
// functions or templates of other libraries along that these units would use.

namespace kinship::collision {

inline constexpr int kLanes = 16;        ///< configurations checked side by side
inline constexpr int kLaneJoints = 32;   ///< of a chain, with their mimic joints
inline constexpr int kLaneBodies = 128;  ///< moved by joints
inline constexpr int kPlaceRows = 4;     ///< a sphere's x, y, z, then how far it is from the cloud
inline constexpr int kCoverRows = 5;     ///< centres' x, y, z, then outer and inner radii
inline constexpr int kLaneDoubts = 64;   ///< reported at most

/// A joint, seen from a frame whose z axis is the joint's; lengths in m.
struct LaneJoint {
  float R[9], p[3];  ///< in the moving frame of the joint before, row-major
  int before;        ///< that joint, below its own index; -1: the scene's frame
  bool slides;
  bool is_tilt;  ///< R turns about the x axis alone, by R[7] and R[8], its sine and cosine
};

/// A sphere of a cover. `outer` is larger and `inner` smaller than the true radius by a margin for
/// rounding.
struct LaneSphere {
  float center[3];
  float outer;
  float inner;     ///< not above 0: the inside is unknown
  float point[3];  ///< that belongs to the solid
};

enum class LaneShape {
  Box,
  AlignedBox,  ///< aligned with its frame: `axes` is the identity
  Capsule,
  Cylinder
};

/// A shape that holds a solid, in the frame of the joint that moves it. A sphere is a capsule
/// without length.
struct LaneForm {
  LaneShape shape;
  float axes[9], center[3];  ///< axes of the shape's frame: row-major, one per column
  float half[3];             ///< of a box; of a capsule or cylinder [2], of the straight part
  float radius;              ///< of a capsule or cylinder
};

/// A solid that a joint moves: a form, one sphere around all of it, and spheres that cover it
/// closely, all in the joint's moving frame.
struct LaneBody {
  int joint;
  int link;  ///< of LaneScene::link
  LaneForm form;
  bool is_solid;     ///< false: a surface somewhere within the form, near its spheres
  float radius;      ///< of the sphere about the form's centre
  int first, count;  ///< of LaneScene::spheres
  int first_cover;   ///< of LaneScene::cover: the same spheres, kCoverRows times `room`
  int room;          ///< capacity, a multiple of kLanes
  int first_reach;   ///< of LaneScene::reach: a word per block, of obstacles it may touch
};

/// Two bodies that may not touch each other.
struct LaneOther {
  int body, other;
  float reach;       ///< bodies with centres farther apart do not touch, m
  float link_reach;  ///< the same of `body` and the other one's link
  int next;          ///< index of the next one of another `body`
};

/// The bodies that one joint moves, and one sphere around all of them.
struct LaneLink {
  int joint;
  float center[3];
  float radius;
  int first, count;  ///< of LaneScene::body
  int first_reach;   ///< as of LaneBody: what any of them may touch
  int first_pair,
      pairs;  ///< of LaneScene::link_pairs: earlier links whose bodies they may not touch
};

/// An earlier link, and the pairs of its bodies and the link's.
struct LaneLinkPair {
  int other;
  int both;          ///< the last joint that moves both, -1: none
  float reach;       ///< links with centres farther apart do not touch, m
  int first, count;  ///< of LaneScene::others
};

/// A solid that stands still, in the scene's frame.
struct LaneObstacle {
  LaneForm form;
  bool is_solid;     ///< false: a surface somewhere within the form, near its spheres
  bool is_in_grid;   ///< the grid knows all of it
  int first, count;  ///< of LaneScene::spheres; for surfaces only
};

/// Lower bounds on the distance of a cloud's cubes from the middles of cells, x fastest, m.
struct LaneGrid {
  const float* distances;  ///< null: there is no cloud
  float R[9], p[3];        ///< of the scene in the grid's frame, whose origin is its corner
  float cell;              ///< side of a cell, m
  bool is_exact;           ///< a cell at distance 0 is within the cloud
  int cells[3];
  float center[3], half[3];  ///< of the box that holds all cubes, in the grid's frame
};

/// A robot and its surroundings, as plain numbers, in a frame at the base's origin with the axes of
/// the surrounding boxes, if most of these have the same.
struct LaneScene {
  int moving_joints, links;
  float slack;  ///< largest rounding error of a distance, m
  const LaneJoint* joints;
  const LaneLink* link;
  const LaneBody* body;
  const LaneObstacle* obstacle;
  int blocks;             ///< of kLanes obstacles
  const float* bounds;    ///< of each block: kLanes least x, y, z, then kLanes largest
  const unsigned* reach;  ///< of each body and block: a bit per obstacle
  const LaneSphere* spheres;
  const float* cover;  ///< filled up with a far sphere without an inside
  const LaneLinkPair* link_pairs;
  const LaneOther* others;
  LaneGrid grid;
};

/// A body and an obstacle or body that it may touch.
struct LaneDoubt {
  std::uint32_t lanes;
  int body;
  int obstacle, other;  ///< one of them, the other one is -1
};

/// Which lanes need an answer; the others are set in `surely`.
enum class LaneScope {
  Each,
  Ahead,  ///< those up to the first sure collision
  All     ///< any, if one surely collides: whether all are free
};

/// Sixteen configurations and the result for each. Index of lanes last; bit i: lane i.
struct alignas(64) LaneQuestion {
  float q[kLaneJoints]
         [kLanes];  ///< the joint's value plus the turn of its frame, rad in [-pi, pi], or m
  int count;        ///< lanes in use, from 0 on
  /// Growth, m, of pairs of a moving and a standing body, and of two moving ones: bodies that may
  /// not collide have so much room. Bodies that surely collide do so without growth.
  float standing_room, moving_room;
  /// Whether each joint may be farther from its value, by at most `change`, rad or m: bodies that
  /// may not collide do not in any of these configurations either.
  bool moves;
  float change[kLaneJoints][kLanes];
  LaneScope scope;
  /// The only pairs that are looked at, each in its lanes, if `pairs` is not negative.
  LaneDoubt pair[kLaneDoubts];
  int pairs;
  int likely_link, likely_body,
      likely_obstacle;   ///< tried first; out: the last that surely collided
  std::uint32_t maybe;   ///< out: may collide; the others are free for sure
  std::uint32_t surely;  ///< out: collides for sure; a part of maybe
  /// Out: the bodies that may collide in lanes that do not collide for sure; the first kLaneDoubts
  /// of `doubts`. Nothing else touches there.
  LaneDoubt doubt[kLaneDoubts];
  int doubts;
};

/// Answers a question. \param places  room for kPlaceRows * kLanes floats per sphere of the bodies,
/// aligned as a LaneQuestion. No heap, no state.
using LaneKernel = void (*)(const LaneScene& scene, LaneQuestion& question, float* places);

/// The kernel of one instruction set and its name.
struct LaneSet {
  std::string_view name;  ///< "sse2", "avx2", "avx512vl", "avx512"
  LaneKernel kernel;
};

/// The instruction sets of this machine, the slowest first; at least one.
std::span<const LaneSet> lane_sets();

// One unit each; to be called only where the machine knows the instructions.
void check_lanes_sse2(const LaneScene&, LaneQuestion&, float*);  ///< the compiler's baseline
void check_lanes_avx2(const LaneScene&, LaneQuestion&, float*);
void check_lanes_avx512vl(const LaneScene&, LaneQuestion&, float*);  ///< eight at once
void check_lanes_avx512(const LaneScene&, LaneQuestion&, float*);

}  // namespace kinship::collision
