#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/distribution.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::plots {

/// Equal bins between the limits of a joint: the outermost one is the fiftieth part at a limit.
inline constexpr std::size_t kMarginalBins = 50;

/// Histogram of a distribution's samples over the values of one joint.
struct Marginal {
  std::string joint;
  bool is_length = false;             ///< m; otherwise rad
  double lower = 0, upper = 0;        ///< limits; of a continuous joint -pi and pi
  std::optional<double> cut;          ///< of a continuous joint, in [-pi, pi]: its branch cut
  std::vector<std::uint64_t> counts;  ///< kMarginalBins of them, from `lower` to `upper`
};

/// \param samples  dof x n, as a DistributionSampler draws them.
/// \throws std::invalid_argument if chain, distribution and samples differ in the number of joints.
/// \throws Failure(InvalidInput) if limits are not finite, or a lower one lies above its upper one.
std::vector<Marginal> marginals_of(const Distribution& distribution, const kinematics::Chain& chain,
                                   const Eigen::Ref<const Eigen::MatrixXd>& samples);

}  // namespace kinship::plots
