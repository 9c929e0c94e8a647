#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pages/page/bones.hpp"
#include "pages/plots/drawn_robot.hpp"
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

/// A distribution by samples of it.
struct Samples {
  Eigen::Matrix3Xd hands;  ///< origin of the transfer frame in the task frame, m: one per sample
  std::vector<Marginal> marginals;
};

/// Seeded: equal distribution, equal samples.
/// \param distribution  with a mixture, of the chain.
/// \throws Failure(NotFound) if none of it lies within the limits; the errors of marginals_of.
Samples samples_of(const Distribution& distribution, const kinematics::Chain& chain,
                   Eigen::Index count);

/// One Gaussian of a mixture, or kernel, by weight.
struct Component {
  double weight = 0;     ///< 0 to 1
  double cumulated = 0;  ///< of it and all heavier ones
};

inline constexpr std::size_t kMaxComponentsShown = 200;

/// The heaviest components of a mixture, heaviest first, kMaxComponentsShown at most.
std::vector<Component> heaviest_components(const Mixture& mixture);

/// The robot in the mean of one component.
struct Posture {
  double weight = 0;  ///< of that component
  std::vector<page::Bone> bones;
};

/// The content of a distribution's page, derived from the distribution and its robot.
struct DistributionPlot {
  Distribution distribution;
  std::string label;  ///< of its robot
  std::vector<Component> components;
  Samples samples;
  std::vector<Posture> postures;  ///< of the heaviest components, heaviest first
  std::string shapes;             ///< text on the known shapes of the robot
};

inline constexpr std::size_t kSamplesShown = 2000;

/// Draws the samples (seeded: equal distribution, equal plot) and places the robot in the task
/// frame, or that of its base if the distribution has no placement.
/// \param drawn  the distribution's robot, as the server keeps it.
/// \throws Failure(NotFound) if there is no mixture or none of it lies within the limits;
///         InvalidInput if it is of another robot.
DistributionPlot plot_of(Distribution distribution, const DrawnRobot& drawn);

}  // namespace kinship::plots
