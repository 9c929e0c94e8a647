#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/problem.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::guided {

/// Why a problem does not fit a robot.
struct Mismatch {
  NotPlanned kind = NotPlanned::DofMismatch;
  std::string text;  ///< for people
};

/// A problem whose starts and goals beyond a limit by less than the slack, as a rounded limit
/// causes, are moved onto the limit. Continuous joints have none.
class WithinLimits {
 public:
  /// \param slack    joint units; 0: nothing is moved.
  /// \param problem  outlives the object; one with another number of joints is not changed.
  WithinLimits(const kinematics::Chain& chain, const Problem& problem, double slack);

  const Problem& problem() const noexcept { return moved_ ? *moved_ : problem_; }

  /// A sentence per move: "start: joint 'wrist' at 3.141593 is moved onto its limit 3.14159".
  const std::vector<std::string>& said() const noexcept { return said_; }

 private:
  const Problem& problem_;
  std::optional<Problem> moved_;  // empty: nothing was
  std::vector<std::string> said_;
};

/// The first mismatch: another number of joints, or a start or goal beyond a limit.
std::optional<Mismatch> find_mismatch(const kinematics::Chain& chain, const Problem& problem);

/// A problem's placement that is another one than that of its guidance, by more than what requests
/// are snapped to.
std::optional<Mismatch> find_other_placement(const Problem& problem,
                                             const Eigen::Isometry3d& T_task_base);

}  // namespace kinship::guided
