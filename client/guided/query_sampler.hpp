#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "client/guided/plan_settings.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/problem.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/recall/recall_guide.hpp"

namespace kinship::guided {

/// A task's experience as guidance for a robot's queries at one placement: a distribution, stored
/// ways of the hand, or both.
struct Guidance {
  std::optional<Digest> distribution_id;  ///< present exactly if there is a mixture
  std::uint64_t revision = 0;             ///< of the distribution
  std::optional<Mixture> mixture;
  std::shared_ptr<const planning::ExperienceGuide> experience;  ///< null: none
  std::shared_ptr<const recall::RecallGuide> recall;            ///< null: none
  double guided_fraction = 0;  ///< of the samples of a guided query
  Guide guide = Guide::All;    ///< the parts that a guided query uses
  /// The placement that it was made for, and that its queries have; missing: not checked.
  std::optional<Eigen::Isometry3d> T_task_base = {};
};

/// The guidance of a query, and whether the query uses it.
struct QueryGuidance {
  const Guidance* guidance = nullptr;  ///< null: there is none
  SamplingMode sampling_mode =
      SamplingMode::Uniform;  ///< Guided uses it; Control and Uniform plan without
  double recall_trust = 1;    ///< of the chances that the library tells, 0 to 1
  std::string why_not = {};   ///< for people: why there is none
};

/// The sampler of a query; for a guided one that of planning::guided_sampler.
/// \param guidance  null: uniform, as for a `result` whose sampling mode is not Guided.
/// \param result    receives guide, share, track_share, experience_revision, gate_fired,
///                  guidance_reason.
planning::ConfigurationSampler make_query_sampler(const kinematics::Chain& chain,
                                                  const planning::TrackQuery& query,
                                                  const Guidance* guidance,
                                                  const PlanSettings& settings,
                                                  ProblemResult& result);

}  // namespace kinship::guided
