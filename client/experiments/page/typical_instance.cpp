#include "client/experiments/page/typical_instance.hpp"

#include <algorithm>
#include <cmath>

#include "client/experiments/page/hand_poses.hpp"
#include "client/experiments/statistics.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

std::optional<TypicalInstance> find_typical(const std::vector<ProblemResult>& uniform,
                                            const std::vector<ProblemResult>& guided) {
  std::map<std::string, const ProblemResult*> by_name;
  for (const ProblemResult& result : guided)
    by_name.emplace(result.name, &result);
  std::vector<TypicalInstance> candidates;
  std::vector<double> ratios;
  for (const ProblemResult& result : uniform) {
    const auto other = by_name.find(result.name);
    if (other == by_name.end() || !result.waypoints || !other->second->waypoints)
      continue;
    ratios.push_back(
        static_cast<double>(result.collision_checks) /
        static_cast<double>(std::max<std::uint64_t>(1, other->second->collision_checks)));
    candidates.push_back(
        {result.name, result.collision_checks, other->second->collision_checks, ratios.back()});
  }
  if (candidates.empty())
    return std::nullopt;
  const double middle = median(ratios);
  TypicalInstance typical = *std::ranges::min_element(
      candidates, {}, [&](const TypicalInstance& each) { return std::abs(each.ratio - middle); });
  typical.median_ratio = middle;
  typical.candidates = candidates.size();
  return typical;
}

GrownSearch grown(const models::LoadedRobot& robot, const Problem& problem,
                  const RecordedSearch& search) {
  if (search.nodes.cols() > 0 && search.nodes.rows() != robot.chain.dof())
    throw Failure(ErrorCode::InvalidInput, "the search of '" + search.name + "' has " +
                                               std::to_string(search.nodes.rows()) + " joints, " +
                                               robot.description.label + " " +
                                               std::to_string(robot.chain.dof()));
  return {poses_of(robot.chain, problem.T_task_base.value_or(Eigen::Isometry3d::Identity()),
                   search.nodes)
              .positions,
          search.parents, search.path, search.checks};
}

}  // namespace kinship::experiments
