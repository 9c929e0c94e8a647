#pragma once

#include "robots/kinematics/chain.hpp"

namespace kinship::kinematics {

/// How alike two chains move their transfer frames.
enum class ArmLikeness {
  Different,
  Near,   ///< calibrated units of one type: a configuration needs a polish to give the same pose
  Exact,  ///< equal apart from rounding: a configuration gives the same pose
};

inline constexpr int kArmComparisons = 100;    ///< configurations that are compared
inline constexpr double kNearArm_m = 5e-3;     ///< largest distance of near arms
inline constexpr double kNearArm_rad = 10e-3;  ///< largest angle of near arms
inline constexpr double kExactArm = 1e-8;      ///< m and rad; model files round to 1e-9

/// Whether two chains are the same arm: joint by joint the same kind of motion, and, at each of
/// kArmComparisons fixed configurations, poses of the transfer frame in the base link that lie
/// within the tolerances of each other.
///
/// Revolute and continuous joints are the same kind. Names, limits, task axes and links do not
/// count, but the configurations are spread over the limits that both chains have in common, with
/// one in the middle: without a common interval of some joint the arms are Different. Symmetric;
/// Near is not transitive. Equal on every machine but for the last bits of a sine.
ArmLikeness compare_arms(const Chain& a, const Chain& b);

}  // namespace kinship::kinematics
