#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "client/planner/plan_settings.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/problem.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/experience_guide.hpp"

namespace kinship::planner {

/// What a task's experience gives a robot, for all queries from one placement: a distribution, or
/// stored ways of the hand, or both.
struct Guidance {
  std::optional<Digest> distribution_id;  ///< present exactly if there is a mixture
  std::uint64_t revision = 0;             ///< of the distribution
  std::optional<Mixture> mixture;
  std::shared_ptr<const planning::ExperienceGuide> experience;  ///< null: none
  double guided_fraction = 0;  ///< of the samples of a guided query
};

/// What guidance a query has, and whether it uses it.
struct QueryGuidance {
  const Guidance* guidance = nullptr;  ///< null: there is none
  SamplingMode sampling_mode =
      SamplingMode::Uniform;  ///< Guided uses it; Control and Uniform plan without
  std::string why_not = {};   ///< for people: why there is none
};

/// One query as its sampler needs it.
struct PosedQuery {
  const kinematics::Chain& chain;
  Eigen::Isometry3d T_task_base;
  const Eigen::Matrix2Xd& bounds;  ///< 2 x dof
  const Eigen::VectorXd& start;    ///< dof
  const Eigen::MatrixXd& goals;    ///< dof x n
};

/// Where the samples of a guided query come from. Of those that guidance may have, tracks and
/// mixture have their parts (settings.tracks), or the mixture all where there are no tracks. A
/// mixture that the query is far from gives fewer, the fewer the farther (settings.gate_distance):
/// it says little about what lies between.
/// \param guidance  null: uniform.
/// \param result    told: share, track_share, experience_revision, gate_fired, guidance_reason.
planning::ConfigurationSampler make_query_sampler(const PosedQuery& query, const Guidance* guidance,
                                                  const PlanSettings& settings,
                                                  ProblemResult& result);

}  // namespace kinship::planner
