#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// Rounding by which a joint may lie outside its limits before it is moved onto them, joint units.
/// The result must then be verified before it counts as a solution.
inline constexpr double kLimitRounding = 1e-6;

/// The joints of one chain for computations on thousands of configurations, without their names.
class JointSpace {
 public:
  explicit JointSpace(const kinematics::Chain& chain);

  Eigen::Index dof() const noexcept { return static_cast<Eigen::Index>(joints_.size()); }

  /// Replaces each joint's value by the representative of its +-2 pi copies: continuous joints in
  /// (-pi, pi], revolute joints nearest mid-range, prismatic joints as they are.
  /// \param q       dof, joint units.
  /// \param margin  by which a value may lie outside a limit before it is moved onto it.
  /// \return        whether every joint is then within its limits.
  bool normalize(double* q, double margin = kLimitRounding) const noexcept;

  /// Euclidean, squared, 1 m = 1 rad; wrapped for continuous joints only, since a joint with limits
  /// cannot take the short way across them.
  /// \param most  where the distance is that or more, so is the result, which may be too small.
  double squared_distance(const double* a, const double* b,
                          double most = std::numeric_limits<double>::infinity()) const noexcept;

  /// The value of a joint for a number in [0, 1): uniform within its limits; within a turn around
  /// mid-range if they are wider.
  double value_at(Eigen::Index joint, double share) const noexcept {
    const Range& range = joints_[static_cast<std::size_t>(joint)];
    return range.middle + (2 * share - 1) * range.half_drawn;
  }

  /// The same without regard to limits: a whole turn, or twice the range of a prismatic joint.
  double value_anywhere(Eigen::Index joint, double share) const noexcept {
    const Range& range = joints_[static_cast<std::size_t>(joint)];
    return range.middle + (2 * share - 1) * range.half_anywhere;
  }

 private:
  struct Range {
    explicit Range(const kinematics::Joint& joint);
    double lower, upper, middle;
    double half_drawn;  ///< half the interval that values are drawn from
    double half_anywhere;
    bool turns;  ///< values a whole turn apart are equivalent
    bool continuous;
  };
  std::vector<Range> joints_;
};

}  // namespace kinship::inverse
