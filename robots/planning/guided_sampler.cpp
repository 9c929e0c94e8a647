#include "robots/planning/guided_sampler.hpp"

#include <algorithm>
#include <utility>

namespace kinship::planning {
namespace {

/// How much of its part a mixture gets, 0 to 1: all up to the gate's distance.
double trust(const kinematics::Chain& chain, const TrackQuery& query, const Mixture& mixture,
             double gate_distance) {
  constexpr double kLeast = 0.01;
  const QueryDistance distance = query_distance(chain, mixture, query.start, query.goals);
  const double ratio = gate_distance / std::max(distance.start, distance.goal);
  if (!(ratio < 1))
    return 1;
  return ratio * ratio < kLeast ? 0 : ratio * ratio;
}

/// What of the tracks a guide leaves.
TrackOptions tracks_of(Guide guide, TrackOptions options) {
  if (!has_retreat(guide))
    options.retreat_m.reset();
  if (!has_ways(guide))
    options.paths = 0;
  return options;
}

}  // namespace

GuidedSampler guided_sampler(const kinematics::Chain& chain, const TrackQuery& query,
                             const Mixture* mixture,
                             std::shared_ptr<const ExperienceGuide> experience,
                             const GuideOptions& options) {
  const TrackOptions tracks = tracks_of(options.guide, options.tracks);
  const bool has_tracks = experience != nullptr && (tracks.retreat_m || tracks.paths > 0);
  const double mixture_part = options.guided_fraction * (has_tracks ? tracks.mixture_fraction : 1);
  GuidedSampler guided{ConfigurationSampler(query.bounds)};
  if (mixture != nullptr && has_mixture(options.guide) && mixture_part > 0) {
    const double part = trust(chain, query, *mixture, options.gate_distance);
    guided.gate_fired = part < 1;
    guided.mixture_share = part * mixture_part;
    if (guided.mixture_share > 0)
      guided.sampler = ConfigurationSampler(query.bounds, chain, *mixture, guided.mixture_share);
  }
  if (!has_tracks || options.guided_fraction == 0)
    return guided;
  guided.track_share = options.guided_fraction * tracks.sample_fraction;
  guided.sampler = guided.sampler.with_tracks(
      std::make_shared<QueryTracks>(std::move(experience), query, tracks), guided.track_share);
  return guided;
}

}  // namespace kinship::planning
