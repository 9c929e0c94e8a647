#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "proto/types/mixture.hpp"
#include "proto/types/rehearsal.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/experience_guide.hpp"

namespace kinship::planning {

/// A configuration beyond this squared Mahalanobis distance from every component of a mixture is
/// unrelated to the experience behind it.
inline constexpr double kGateDistance = 60;
/// Added to each variance before distances are measured, squared joint units: a narrow component is
/// no wall. With it kGateDistance was found not to fire on good distributions.
inline constexpr double kGateVariance = 0.05 * 0.05;

/// The mixture with kGateVariance added to each variance.
Mixture widened(const Mixture& mixture);

/// Distance of a query from a distribution: squared Mahalanobis distances to the nearest component,
/// dimensionless, its variances widened by kGateVariance.
struct QueryDistance {
  double start = 0;
  double goal = 0;  ///< of the nearest goal; infinite if there is none
};

/// Joints wider than a turn count by the shorter way around.
/// \param start  dof.
/// \param goals  dof x n.
/// \throws std::invalid_argument if chain, mixture, start and goals differ in size.
/// \throws Failure(Internal) if a covariance is not positive definite.
QueryDistance query_distance(const kinematics::Chain& chain, const Mixture& mixture,
                             const Eigen::Ref<const Eigen::VectorXd>& start,
                             const Eigen::Ref<const Eigen::MatrixXd>& goals);

/// How a query uses its guidance.
struct GuideOptions {
  Guide guide = Guide::All;
  double guided_fraction = 1;  ///< of the samples, 0 to 1
  TrackOptions tracks = {};    ///< except `retreats`, which the guide sets
  /// Beyond it a mixture gives fewer samples, far beyond it none (query_distance).
  double gate_distance = kGateDistance;
};

/// The sampler of a query and its shares.
struct GuidedSampler {
  ConfigurationSampler sampler;
  double track_share = 0;    ///< of all samples, around tracks
  double mixture_share = 0;  ///< of all samples, of the mixture
  bool gate_fired = false;   ///< the gate reduced the mixture's share
};

/// The guide sets the shares of tracks and mixture in the guided samples; without experience, a
/// guide that uses the mixture takes all from it. The farther the query is from the mixture, the
/// fewer samples the mixture gives: it then says little about the configurations between. The
/// retreat is tried from every goal, but only from the three nearest if stored ways follow.
/// \param mixture     null: there is none.
/// \param experience  null: there is none, and no tracks.
/// \throws std::invalid_argument if a share is not 0 to 1 or sizes differ.
GuidedSampler guided_sampler(const kinematics::Chain& chain, const TrackQuery& query,
                             const Mixture* mixture,
                             std::shared_ptr<const ExperienceGuide> experience,
                             const GuideOptions& options);

}  // namespace kinship::planning
