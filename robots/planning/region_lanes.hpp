#pragma once

// Included by the units that are compiled for one instruction set: nothing here may bring inline
// functions or templates of other libraries along that these units would use.
namespace kinship::planning {

inline constexpr int kSideBySide = 8;      ///< configurations projected side by side
inline constexpr int kLaneJoints = 32;     ///< of a chain at most
inline constexpr int kLaneIterations = 6;  ///< of a projection side by side

/// A region and a chain as plain numbers, in the region's frame: see RegionConstraint.
struct LaneRegion {
  struct Joint {
    float R[9], p[3];  ///< row by row, from the frame before it; its axis is the z-axis
    bool slides;
  };
  Joint joints[kLaneJoints];
  int dof;
  float R_end[9], p_end[3];  ///< after the last joint
  int rows[6], row_count;    ///< the coordinates that are bounded, in order
  bool has_place;            ///< whether one of them is x, y or z
  float lower[6], upper[6];  ///< of x, y, z, roll, pitch, yaw
  float margin[6];           ///< how far inside its bounds a coordinate is aimed at
  float least[kLaneJoints], most[kLaneJoints];  ///< of each joint
  float aimed_squared, squared_damping, least_cosine;
};

/// Moves configurations into the region by damped least squares, each as if it were alone, and
/// rounded alike on all machines.
/// \param qs  joint after joint, kSideBySide values each.
/// \return    a bit for each that arrived.
using ProjectLanes = unsigned (*)(const LaneRegion& region, float* qs);
/// Squared distance of configurations from the region.
using MeasureLanes = void (*)(const LaneRegion& region, const float* qs, float* squared);

// One unit each; to be called only where the machine knows the instructions.
unsigned project_lanes_sse2(const LaneRegion& region, float* qs);  ///< baseline
unsigned project_lanes_avx2(const LaneRegion& region, float* qs);
void measure_lanes_sse2(const LaneRegion& region, const float* qs, float* squared);
void measure_lanes_avx2(const LaneRegion& region, const float* qs, float* squared);

struct RegionKernels {
  ProjectLanes project;
  MeasureLanes measure;
};

/// Those for this machine's instruction set.
const RegionKernels& fastest_region_kernels();

}  // namespace kinship::planning
