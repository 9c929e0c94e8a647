#include "client/guided/query_sampler.hpp"

#include <utility>

namespace kinship::guided {

planning::ConfigurationSampler make_query_sampler(const kinematics::Chain& chain,
                                                  const planning::TrackQuery& query,
                                                  const Guidance* guidance,
                                                  const PlanSettings& settings,
                                                  ProblemResult& result) {
  if (guidance == nullptr || result.sampling_mode != SamplingMode::Guided)
    return planning::ConfigurationSampler(query.bounds);
  result.guide = guidance->guide;
  planning::GuidedSampler guided = planning::guided_sampler(
      chain, query, guidance->mixture ? &*guidance->mixture : nullptr, guidance->experience,
      {.guide = guidance->guide,
       .guided_fraction = guidance->guided_fraction,
       .tracks = settings.tracks,
       .gate_distance = settings.gate_distance});
  result.track_share = guided.track_share;
  result.share = guided.track_share + guided.mixture_share;
  result.gate_fired = guided.gate_fired;
  if (guided.gate_fired)
    result.guidance_reason = "start or goals are far from all that the distribution knows";
  if (guided.track_share > 0)
    result.experience_revision = guidance->experience->experience().revision;
  return std::move(guided.sampler);
}

}  // namespace kinship::guided
