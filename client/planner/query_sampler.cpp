#include "client/planner/query_sampler.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "robots/planning/guidance_gate.hpp"

namespace kinship::planner {
namespace {

/// How much of its part a mixture gets, 0 to 1: all up to the gate's distance.
double trust(const PosedQuery& query, const Mixture& mixture, double gate_distance) {
  constexpr double kLeast = 0.01;
  const planning::QueryDistance distance =
      planning::query_distance(query.chain, mixture, query.start, query.goals);
  const double ratio = gate_distance / std::max(distance.start, distance.goal);
  if (!(ratio < 1))
    return 1;
  return ratio * ratio < kLeast ? 0 : ratio * ratio;
}

}  // namespace

planning::ConfigurationSampler make_query_sampler(const PosedQuery& query, const Guidance* guidance,
                                                  const PlanSettings& settings,
                                                  ProblemResult& result) {
  if (guidance == nullptr || result.sampling_mode != SamplingMode::Guided)
    return planning::ConfigurationSampler(query.bounds);
  const bool has_tracks = guidance->experience != nullptr;
  result.track_share = has_tracks ? guidance->guided_fraction * settings.tracks.sample_fraction : 0;
  const double rest =
      guidance->guided_fraction * (has_tracks ? settings.tracks.mixture_fraction : 1);
  double mixture_share = 0;
  if (guidance->mixture && rest > 0) {
    const double part = trust(query, *guidance->mixture, settings.gate_distance);
    mixture_share = part * rest;
    result.gate_fired = part < 1;
    if (result.gate_fired)
      result.guidance_reason = "start or goals are far from all that the distribution knows";
  }
  result.share = result.track_share + mixture_share;
  planning::ConfigurationSampler sampler =
      mixture_share > 0 ? planning::ConfigurationSampler(query.bounds, query.chain,
                                                         *guidance->mixture, mixture_share)
                        : planning::ConfigurationSampler(query.bounds);
  if (!has_tracks || guidance->guided_fraction == 0)
    return sampler;
  result.experience_revision = guidance->experience->experience().revision;
  auto tracks = std::make_shared<planning::QueryTracks>(
      guidance->experience,
      planning::TrackQuery{query.T_task_base, query.bounds, query.start, query.goals},
      settings.tracks);
  return sampler.with_tracks(std::move(tracks), result.track_share);
}

}  // namespace kinship::planner
