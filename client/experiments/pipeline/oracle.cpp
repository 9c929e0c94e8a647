#include "client/experiments/pipeline/oracle.hpp"

#include "client/guided/plan_problem.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::experiments {

std::optional<guided::Guidance> oracle_guidance(const StudyMember& member, const Problem& problem,
                                                const guided::PlanSettings& settings,
                                                double deviation) {
  constexpr std::uint64_t kShortcutChecks = 1000;
  guided::PlanSettings shortened = settings;
  shortened.shortcut_checks = kShortcutChecks;
  const guided::PlannedProblem planned =
      guided::plan_problem(member.planned, problem, {}, shortened, [] { return false; });
  if (!planned.result.waypoints)
    return std::nullopt;
  const Eigen::MatrixXd along = planning::densified(*planned.result.waypoints, deviation);
  const Eigen::Index dof = along.rows();
  guided::Guidance guidance;
  guidance.distribution_id = Digest{};
  guidance.mixture =
      Mixture(Eigen::VectorXd::Constant(along.cols(), 1.0 / static_cast<double>(along.cols())),
              along, {Eigen::MatrixXd::Identity(dof, dof) * deviation * deviation});
  guidance.guide = Guide::Mixture;
  guidance.guided_fraction = 1;
  return guidance;
}

}  // namespace kinship::experiments
