#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/robots.hpp"

namespace kinship::bench {

/// Poses of the transfer frame of random configurations within the limits; always the same.
inline std::vector<Eigen::Isometry3d> reachable_poses(const kinematics::Chain& chain, int count) {
  std::mt19937_64 generator(1);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i)
    poses.push_back(
        kinematics::T_base_transfer(chain, test::random_configuration(chain, generator)));
  return poses;
}

}  // namespace kinship::bench
