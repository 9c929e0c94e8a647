#include "client/plots/marginals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "proto/types/failure.hpp"
#include "proto/types/turn.hpp"

namespace kinship::plots {
namespace {

/// The bin of a value; one rounded beyond an end belongs to the last bin. The middle one for a
/// joint that cannot move.
std::size_t bin_of(double value, const Marginal& marginal) {
  if (marginal.lower == marginal.upper)
    return kMarginalBins / 2;
  const double part = (value - marginal.lower) / (marginal.upper - marginal.lower);
  const double bin = part * static_cast<double>(kMarginalBins);
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kMarginalBins - 1)));
}

void require_range(const Marginal& marginal) {
  if (!std::isfinite(marginal.upper - marginal.lower) || marginal.lower > marginal.upper)
    throw Failure(ErrorCode::InvalidInput, "limits of joint '" + marginal.joint + "' are " +
                                               std::to_string(marginal.lower) + " to " +
                                               std::to_string(marginal.upper) +
                                               ", must be finite and the lower one first");
}

}  // namespace

std::vector<Marginal> marginals_of(const Distribution& distribution, const kinematics::Chain& chain,
                                   const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const Eigen::Index dof = chain.dof();
  if (distribution.limits.cols() != dof || samples.rows() != dof)
    throw std::invalid_argument("marginals_of: " + std::to_string(dof) + " joints, limits of " +
                                std::to_string(distribution.limits.cols()) + ", samples of " +
                                std::to_string(samples.rows()));
  std::vector<Marginal> marginals;
  for (Eigen::Index joint = 0; joint < dof; ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    Marginal marginal;
    marginal.joint = chain.joints()[index].name;
    marginal.is_length = chain.joints()[index].type == kinematics::JointType::Prismatic;
    marginal.lower = distribution.limits(0, joint);
    marginal.upper = distribution.limits(1, joint);
    if (index < distribution.cuts.size() && distribution.cuts[index]) {
      marginal.cut = wrapped(*distribution.cuts[index]);
      marginal.lower = -std::numbers::pi;
      marginal.upper = std::numbers::pi;
    }
    require_range(marginal);
    marginal.counts.resize(kMarginalBins);
    for (const double value : samples.row(joint))
      ++marginal.counts[bin_of(value, marginal)];
    marginals.push_back(std::move(marginal));
  }
  return marginals;
}

}  // namespace kinship::plots
