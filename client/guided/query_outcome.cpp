#include "client/guided/query_outcome.hpp"

#include "robots/planning/repetition_roadmap.hpp"

namespace kinship::guided {

using planning::NoPath;

std::string why_unguided(const QueryGuidance& query) {
  if (query.guidance == nullptr)
    return query.why_not;
  switch (query.sampling_mode) {
    case SamplingMode::Control:
      return "planned uniformly as control";
    case SamplingMode::Uniform:
      return "planned uniformly by wish";
    case SamplingMode::Guided:
      break;
  }
  if (query.guidance->guide == Guide::None)
    return "by rehearsal nothing is better than uniform planning";
  return query.guidance->guided_fraction == 0 ? "the share of guided samples is 0" : "";
}

std::string planner_text(const PlannerChoice& planner,
                         const planning::ConfigurationSampler& sampler) {
  const std::string name = name_of(planner);
  if (planner.kind != PlannerKind::Roadmap || !sampler.mixture() ||
      sampler.mixture()->size() <= planning::kMaxRoadmapComponents)
    return name;
  return name + " (trees alone: " + std::to_string(sampler.mixture()->size()) +
         " components exceed " + std::to_string(planning::kMaxRoadmapComponents) + ")";
}

Outcome outcome_of(const planning::PlanSummary& summary) {
  if (summary.waypoints)
    return Outcome::Solved;
  const bool is_used_up =
      summary.reason == NoPath::MaxChecks || summary.reason == NoPath::TimeLimit;
  return is_used_up ? Outcome::Timeout : Outcome::Failed;
}

std::optional<NotPlanned> not_planned_by(NoPath reason) {
  switch (reason) {
    case NoPath::StartOutOfReach:
      return NotPlanned::StartOutOfReach;
    case NoPath::StartBeyondLimits:
      return NotPlanned::StartBeyondLimits;
    case NoPath::StartNotFound:
      return NotPlanned::StartNotFound;
    case NoPath::StartCollides:
      return NotPlanned::StartCollides;
    case NoPath::StartOffConstraint:
      return NotPlanned::StartOffConstraint;
    case NoPath::GoalOutOfReach:
      return NotPlanned::GoalOutOfReach;
    case NoPath::GoalBeyondLimits:
    case NoPath::GoalOutsideBounds:
      return NotPlanned::GoalBeyondLimits;
    case NoPath::NoGoal:
    case NoPath::GoalNotFound:
      return NotPlanned::GoalNotFound;
    case NoPath::GoalsCollide:
      return NotPlanned::GoalCollides;
    case NoPath::GoalsOffConstraint:
      return NotPlanned::GoalOffConstraint;
    default:
      return std::nullopt;
  }
}

}  // namespace kinship::guided
