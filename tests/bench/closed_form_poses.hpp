#pragma once

#include <Eigen/Geometry>
#include <random>
#include <span>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/robots.hpp"

namespace kinship {

/// A pose that a closed form is asked for, and the configuration that it came from.
struct LockedPose {
  Eigen::VectorXd q;                  ///< random, within the limits
  Eigen::Isometry3d T_base_transfer;  ///< of q
  std::vector<double> locked;         ///< the values of the locked joints in q
};

/// Always the same `count` poses of a chain.
/// \param locks  joints that are locked, 0 the first.
inline std::vector<LockedPose> locked_poses(const kinematics::Chain& chain,
                                            std::span<const int> locks, int count) {
  std::mt19937_64 generator(3);
  std::vector<LockedPose> poses;
  for (int i = 0; i < count; ++i) {
    LockedPose pose;
    pose.q = test::random_configuration(chain, generator);
    pose.T_base_transfer = kinematics::T_base_transfer(chain, pose.q);
    for (const int joint : locks)
      pose.locked.push_back(pose.q[joint]);
    poses.push_back(std::move(pose));
  }
  return poses;
}

}  // namespace kinship
