#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "robots/inverse/descent.hpp"

namespace kinship::transfer {

class ShapeTracker;

/// What one lane does for a try of a tracker: the pull where the try starts, or the way from there
/// to one end of the path, pose by pose.
struct Walk {
  ShapeTracker* tracker = nullptr;
  std::size_t of_round = 0;    ///< the try, by its place in the tracker's round
  Eigen::Index direction = 0;  ///< 1 or -1: to an end of the path; 0: the pull at the start
  Eigen::Index pose = 0;       ///< where it is
  inverse::JointVector q;      ///< there, as the lanes have it: a joint may be turns away
};

}  // namespace kinship::transfer
