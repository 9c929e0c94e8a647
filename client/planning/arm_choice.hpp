#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/advice.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"

namespace kinship::planning {

/// What a user says about guidance; what is missing follows the server's advice.
struct ArmOptions {
  std::optional<double> share;          ///< of guided samples, 0 to 1
  std::optional<double> control_share;  ///< of queries that test the advice, 0 to 1
};

/// How the queries of a run are divided between guided and uniform planning.
///
/// The server can judge guidance only if the same client plans both ways and chance decides
/// which. So a small part of the queries does the opposite of what is advised: where guidance is
/// advised, they are planned uniformly (control); where it is not, they are guided.
struct ArmPlan {
  double share = 0;       ///< of guided samples in a guided query
  bool is_guided = true;  ///< whether the usual query is guided
  double trial_part = 0;  ///< of queries that do the opposite

  bool operator==(const ArmPlan&) const = default;
};

/// How one query is planned.
struct ArmChoice {
  Arm arm = Arm::Uniform;
  double share = 0;  ///< 0 unless guided

  bool operator==(const ArmChoice&) const = default;
};

inline constexpr std::uint64_t kEarlyTrials = 20;  ///< attempts after which trials become rare
inline constexpr double kEarlyTrialPart = 0.1;
inline constexpr double kLateTrialPart = 0.02;
inline constexpr double kTrialShare = 0.9;  ///< where uniform is advised, which names no share
/// Advice below this is taken as "uniform": queries with next to no guided samples would count as
/// guided, and say nothing about guidance.
inline constexpr double kLeastShare = 0.05;

/// The usual query is guided with the wished or the recommended share, or uniform if the wish is 0
/// or the advice below kLeastShare.
/// Trials are a tenth of the queries until the server knows kEarlyTrials attempts of the arm that
/// they belong to, then one in fifty. A user who wishes share 0 plans uniformly always.
/// \throws std::invalid_argument if a share is outside 0 to 1.
ArmPlan plan_arms(const Advice& advice, const ArmOptions& options);

/// The arm of one query, guidance being there: Guided or Control. Equal seed, equal arm.
ArmChoice choose_arm(const ArmPlan& plan, std::uint64_t seed);

/// A number that differs between queries (name, start, goal, seed) and is the same for the same
/// one; it says nothing about the samples that a planner seeded with problem.seed draws.
std::uint64_t arm_seed(const Problem& problem);

}  // namespace kinship::planning
