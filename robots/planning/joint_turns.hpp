#pragma once

#include <Eigen/Core>

#include "proto/types/limits.hpp"

/// For this library's sources only.
namespace kinship::planning {

/// Sines and cosines of the angles of some joints.
struct alignas(16) JointTurns {
  double sine[kMaxDof], cosine[kMaxDof];
};

/// Computes them two at a time, for a third of the library's time; alike on all machines.
/// \param angles  rad, aligned as JointTurns is, up to 1e4: to about 2e-16. An odd number of them
///                has one more value behind it, any.
/// \param count   at most kMaxDof.
void turn_joints(const double* angles, Eigen::Index count, JointTurns& turns);

}  // namespace kinship::planning
