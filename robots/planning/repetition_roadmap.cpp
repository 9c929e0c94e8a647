#include "robots/planning/repetition_roadmap.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "robots/planning/path_vertices.hpp"
#include "robots/planning/roadmap_graph.hpp"
#include "robots/planning/steering.hpp"

namespace kinship::planning {
namespace {

void check_roadmap_options(const RoadmapOptions& options) {
  const auto refuse = [](const char* name, int value) {
    throw std::invalid_argument("plan_roadmap: " + std::string(name) + " " + std::to_string(value) +
                                " is negative");
  };
  if (options.draws < 0)
    refuse("draws", options.draws);
  if (options.neighbours < 0)
    refuse("neighbours", options.neighbours);
  if (options.connections < 0)
    refuse("connections", options.connections);
}

/// Data that roadmap and trees of a query share.
template <typename Steering>
struct RoadmapQuery {
  const ConfigurationSampler& sampler;
  const RoadmapOptions& options;
  Steering steering;
  PlanningBudget budget;
  std::mt19937_64& generator;

  PlanSummary plan(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals, const Way& way,
                   const Project& project) {
    BidirectionalSearch trees(sampler, options.tree, steering, budget, generator);
    if (!sampler.mixture() || sampler.mixture()->size() > kMaxRoadmapComponents)
      return trees.run(start, goals);
    Eigen::MatrixXd free_goals;
    if (auto answer = trees.answer_at_once(start, goals, free_goals))
      return *std::move(answer);
    RoadmapGraph graph(start, free_goals, way);
    graph.add_components(sampler, project, options, generator);
    if (auto path = graph.search(budget, options.max_roadmap_checks))
      return trees.summary(std::move(path), NoPath::None);
    return trees.run_from(graph.reached_from_start(), graph.reached_from_goals());
  }
};

}  // namespace

PlanSummary plan_roadmap(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const IsFree& is_free, const ConfigurationSampler& sampler,
                         const RoadmapOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_roadmap", start, goals, sampler, options.tree);
  check_roadmap_options(options);
  RoadmapQuery<StraightSteering> query = {
      sampler, options, StraightSteering(start.size(), options.tree.step),
      PlanningBudget(is_free, options.tree.max_checks, options.tree.time_limit), generator};
  const Way way = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    Eigen::MatrixXd ends(from.size(), 2);
    ends << from, to;
    return std::optional(densified(ends, options.tree.step));
  };
  return query.plan(start, goals, way, [](Eigen::VectorXd&) { return true; });
}

PlanSummary plan_roadmap(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const ConstrainedFreedom& freedom, const ConfigurationSampler& sampler,
                         const RoadmapOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_roadmap", start, goals, sampler, options.tree);
  check_roadmap_options(options);
  RegionConstraint& constraint = freedom.constraint;
  RoadmapQuery<ConstrainedSteering> query = {
      sampler, options, ConstrainedSteering(start.size(), options.tree.step, constraint),
      PlanningBudget(freedom.is_free, options.tree.max_checks, options.tree.time_limit), generator};
  ConstrainedStepper stepper(options.tree.step, constraint);
  const Way way = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    return stepper.way(from, to);
  };
  return plan_along(start, goals, constraint, [&](const Eigen::MatrixXd& reachable) {
    return query.plan(start, reachable, way,
                      [&](Eigen::VectorXd& q) { return constraint.project(q); });
  });
}

}  // namespace kinship::planning
