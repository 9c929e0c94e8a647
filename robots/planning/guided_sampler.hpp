#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "proto/types/mixture.hpp"
#include "proto/types/rehearsal.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/guidance_gate.hpp"

namespace kinship::planning {

/// How much of what there is a query uses.
struct GuideOptions {
  Guide guide = Guide::All;
  double guided_fraction = 1;  ///< of the samples, 0 to 1
  TrackOptions tracks = {};    ///< but for `retreats`, which the guide says
  /// Beyond it a mixture gives fewer of its samples, none far beyond (query_distance).
  double gate_distance = kGateDistance;
};

/// Where the samples of a query come from.
struct GuidedSampler {
  ConfigurationSampler sampler;
  double track_share = 0;    ///< of all samples, around tracks
  double mixture_share = 0;  ///< of all samples, of the mixture
  bool gate_fired = false;   ///< the mixture has less than its part
};

/// Tracks and mixture have parts of the guided samples that the guide says, the mixture all of them
/// where there is no experience. A mixture that the query is far from gives fewer, the fewer the
/// farther: it says little about what lies between. The retreat is tried from every goal, but only
/// from the three nearest where stored ways follow.
/// \param mixture     null: there is none.
/// \param experience  null: there is none, and no tracks.
/// \throws std::invalid_argument if a share is not 0 to 1 or sizes differ.
GuidedSampler guided_sampler(const kinematics::Chain& chain, const TrackQuery& query,
                             const Mixture* mixture,
                             std::shared_ptr<const ExperienceGuide> experience,
                             const GuideOptions& options);

}  // namespace kinship::planning
