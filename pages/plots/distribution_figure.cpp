#include "pages/plots/distribution_figure.hpp"

#include <algorithm>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::plots {
namespace {

bool is_same_place(const std::optional<Eigen::Isometry3d>& first,
                   const std::optional<Eigen::Isometry3d>& second) {
  return first.has_value() == second.has_value() && (!first || first->isApprox(*second, 1e-9));
}

}  // namespace

std::vector<KeptDistribution> kept_beside(const Distribution& distribution,
                                          const kinematics::Chain& chain, const LookUp& look_up) {
  std::vector<DistributionSummary> listed =
      look_up.distributions(distribution.task, distribution.robot);
  std::erase_if(listed, [&](const DistributionSummary& summary) {
    return !has_mixture(summary.state) ||
           !is_same_place(summary.T_task_base, distribution.T_task_base);
  });
  std::ranges::stable_sort(listed, {}, &DistributionSummary::fitted_ms);
  while (listed.size() > kMaxKept) {
    const bool keeps_first = listed.front().id == distribution.id;
    listed.erase(listed.begin() + (keeps_first ? 1 : 0));
  }
  std::vector<KeptDistribution> kept;
  for (DistributionSummary& summary : listed) {
    try {
      const bool is_own = summary.id == distribution.id;
      const Distribution found = is_own ? distribution : look_up.distribution(summary.id);
      kept.push_back({std::move(summary), found.engines, samples_of(found, chain, kSamplesOfKept)});
    } catch (const Failure&) {  // evicted after it was listed, or outside the limits
    }
  }
  return kept;
}

DistributionFigure distribution_figure(Distribution distribution, const LookUp& look_up) {
  const DrawnRobot robot = drawn_robot(look_up.robot(distribution.robot));
  DistributionFigure figure{plot_of(std::move(distribution), robot), {}, {}};
  figure.lost = lost_poses(figure.plot.distribution, robot, look_up);
  figure.kept = kept_beside(figure.plot.distribution, robot.robot.chain, look_up);
  return figure;
}

}  // namespace kinship::plots
