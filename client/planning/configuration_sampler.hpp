#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <random>

#include "proto/mixture/sampler.hpp"
#include "proto/types/mixture.hpp"

namespace kinship::planning {

/// Where a planner's samples come from: a share of them from a mixture, the rest uniform within
/// bounds. Immutable; may be shared.
class ConfigurationSampler {
 public:
  /// Uniform.
  /// \param bounds  2 x dof: lower, upper, joint units (see planning_bounds).
  explicit ConfigurationSampler(Eigen::Matrix2Xd bounds);

  /// \param share  of guided samples, 0 to 1.
  ConfigurationSampler(Eigen::Matrix2Xd bounds, const Mixture& mixture, double share);

  Eigen::VectorXd sample(std::mt19937_64& generator) const;

  const Eigen::Matrix2Xd& bounds() const noexcept { return bounds_; }

 private:
  Eigen::Matrix2Xd bounds_;
  std::optional<mixture::Sampler> guided_;
  double share_ = 0;
};

}  // namespace kinship::planning
