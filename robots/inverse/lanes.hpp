#pragma once

// Included by the units that are compiled for one instruction set: nothing here may bring inline
// functions or templates of other libraries along.
namespace kinship::inverse {

inline constexpr int kLanes = 8;
inline constexpr int kLaneJoints = 32;

/// Treatment of joints outside their limits; see Descent::Limits.
enum class LaneLimits { Steer, Ignore, Hold };

/// A joint, in frames with z along the joints and turned about z so that neighbours differ only by
/// a turn about x. Lengths (and the values of a sliding joint) are in units of the chain's
/// length_m.
struct LaneJoint {
  double p[3];                    ///< in the frame of the joint before
  double tilt_cosine, tilt_sine;  ///< of the turn about x from there
  double twist;                   ///< of a sliding joint: constant turn about z, rad
  double scale, offset;           ///< lane's value = scale * joint's value + offset
  double middle, half;            ///< of the limits, lane's values
  bool slides;
  bool bounded;  ///< has less than a turn of room
};

/// A chain for the descent: plain numbers, lengths in units of length_m.
struct LaneChain {
  int dof;
  int rows;                       ///< number of task axes that matter
  int row_of[6];                  ///< the rows that matter, then 6 for a row of zeros
  double length_m;                ///< the unit of length
  double R_first[9], p_first[3];  ///< frame of the first joint in the base link, row-major
  LaneJoint joints[kLaneJoints];  ///< p and tilt of the first are not used
  double R_last[9], p_last[3];    ///< transfer frame in the last frame
};

/// Eight descents side by side, each towards its own pose. Index of lanes last.
struct alignas(64) LaneBatch {
  double target[12][kLanes];      ///< R row-major, then p, in the base link
  double q[kLaneJoints][kLanes];  ///< lane's values; in: where to start; out: one step on
  double squared[kLanes];         ///< out: squared task error before the step
  double moved[kLanes];           ///< out: squared length of the step
  double outside[kLanes];         ///< out: not 0 if a joint was steered
};

/// A chain as in its URDF, for the check of the descent's results: original joint axes, lengths in
/// m.
struct LaneArm {
  struct Joint {
    double R[9], p[3], axis[3];
    bool slides;
  };
  int dof;
  Joint joints[kLaneJoints];
  double R_last[9], p_last[3];
  double matters[6];  ///< 1 or 0 for each task axis
};

/// The errors of eight configurations from their poses, in the task axes that matter.
struct alignas(64) LaneCheck {
  double target[12][kLanes];
  double q[kLaneJoints][kLanes];  ///< joint units
  double distance_m[kLanes];      ///< out
  double angle_rad[kLanes];       ///< out: 2 sin(angle / 2)
};

inline constexpr int kLaneMarks = 4;

/// Points of a chain whose joints all turn, each on the line from a joint to the next one (from the
/// last: to the transfer frame), at `share` of that line from the joint.
struct LaneMarks {
  int joint[kLaneMarks];
  double share[kLaneMarks];
};

/// Postures to be moved until their marks reach wanted positions.
struct alignas(64) LanePull {
  double wanted[3 * kLaneMarks][kLanes];  ///< x, y, z of one mark after the other, in the base, m
  double q[kLaneJoints][kLanes];          ///< lane's values; in: where to start; out: one step on
  double distance_m[kLanes];              ///< out: of the marks before the step, root of squares
};

/// The data of an arm of six turning joints for the elimination of five joint values; see
/// robots/inverse/elimination.hpp.
struct LaneElimination {
  static constexpr int kInvariants = 14;  ///< of the last axis, seen from the second
  static constexpr int kTerms = 27;       ///< 3 of joint 3 by 3 of joint 4 by 3 of joint 5
  static constexpr int kPadded = 32;      ///< kTerms, in whole vectors
  /// Each invariant as a sum over terms: of 1, cos, sin of joint 3, first; of sin^2, sin cos, cos^2
  /// of half of joint 4, then; of 1, cos, sin of joint 5, last.
  double terms[kInvariants][kPadded];
};

/// Tables for functions of an angle that are sums of sines and cosines of its multiples.
struct LaneHarmonics {
  static constexpr int kDegree = 8;
  static constexpr int kCoefficients =
      2 * kDegree + 1;                      ///< of 1, cos, .. cos 8, then sin, .. sin 8
  static constexpr int kPadded = 24;        ///< kCoefficients, in whole vectors
  static constexpr int kSamples = 24;       ///< that coefficients are computed from
  static constexpr int kIntervals = 256;    ///< of the searched turn
  static constexpr int kPoints = 136;       ///< ends of the first half of these; in whole vectors
  double cosine[kSamples], sine[kSamples];  ///< of the angles of samples
  double to_coefficients[kSamples][kPadded];
  double at_points[kCoefficients][kPoints];
};

inline constexpr int kLaneBranches = 24;

/// Configurations from the elimination for one pose.
struct LaneBranches {
  int count;
  double q[6][kLaneBranches];  ///< lane's values, any turn; not finite where a step failed
};

inline constexpr int kLaneLocks = 2;

/// Six turning joints, the last three axes of which meet, in a chain whose other joints are locked.
/// Of the first three axes, two neighbours meet at any value of the locks. Read from tip to base if
/// it is the first three of the chain that meet: axes in that order, every angle of other sign.
/// Lengths in units of the arm's size; everything in the base link with every joint at 0.
struct LaneWrist {
  struct Axis {
    double direction[3], point[3];
    bool slides, locked;
  };
  struct Window {
    double cosine_middle, sine_middle, cosine_half;
  };
  int count, locks;  ///< axes; locked ones among them
  Axis axes[6 + kLaneLocks];
  bool carries_on;    ///< whether locks move the axes behind them instead of those before them
  bool last_meet;     ///< of the first three axes, the last two meet; else the first two
  double side[3];     ///< a unit vector across the last axis
  Window windows[6];  ///< of the free joints; see TurnWindow
  double slack;       ///< see SixJointTask::slack
};

/// Branches of a LaneWrist within the windows: those of the first lane, then of the next one.
struct alignas(64) LaneWristBranches {
  static constexpr int kCapacity = 8 * kLanes;
  int count;
  int lane[kCapacity];
  double angles[6][kCapacity];  ///< of the free joints in the order of LaneWrist::axes, rad
  unsigned hard;  ///< of these lanes, as bits: a step was singular, and the branches are left out
  unsigned outside;  ///< of these lanes, as bits: a branch is outside the windows
};

/// The kernels of one instruction set. Pure functions of their arguments: no heap, no state.
struct SimdKernels {
  /// One iteration of damped Levenberg-Marquardt in every lane.
  /// Source: Sugihara, Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt
  /// method, IEEE T-RO 27 (2011), eq. 14, 23.
  void (*step)(const LaneChain& chain, LaneLimits limits, LaneBatch& batch);

  /// Forward kinematics of every lane, compared with its pose.
  void (*check)(const LaneArm& arm, LaneCheck& check);

  /// One step of damped least squares on the distance of the marks in every lane, with the pose of
  /// the transfer frame, which stays, as a heavily weighted part. For chains without sliding
  /// joints.
  /// Source: Levenberg, Quarterly of Applied Mathematics 2 (1944).
  void (*pull)(const LaneChain& chain, const LaneMarks& marks, LanePull& pull);

  /// All real branches of an arm of six turning joints, to be polished: the zeros of the resultant
  /// of six equations in joints 3, 4 and 5. \param target  as LaneBatch::target, of one lane.
  /// Source: see robots/inverse/simd_elimination_kernel.hpp.
  void (*eliminate)(const LaneChain& chain, const LaneElimination& arm,
                    const LaneHarmonics& harmonics, const double (&target)[12],
                    LaneBranches& branches);

  /// The branches of one pose at eight values of the locked joints.
  /// \param wanted  R row-major, then p: the pose times that of all joints at 0, inverted, and all
  ///                inverted where the chain is read from tip to base.
  /// \param locked  lock's values in the order of LaneWrist::axes; rad, or in units of the arm's
  ///                size.
  /// \param most    ends with the lane that reaches so many branches.
  /// Source: see robots/inverse/subproblems.hpp.
  void (*wrist)(const LaneWrist& arm, const double (&wanted)[12],
                const double (&locked)[kLaneLocks][kLanes], int most, LaneWristBranches& branches);
};

// One unit each; to be called only where the machine knows the instructions.
SimdKernels sse2_simd_kernels();  ///< the compiler's baseline, which on x86-64 is SSE2
SimdKernels avx2_simd_kernels();
SimdKernels avx512_simd_kernels();

}  // namespace kinship::inverse
