#include "client/plots/benefit.hpp"

#include <algorithm>
#include <map>

#include "proto/evidence/attempt_window.hpp"
#include "proto/evidence/cost_ratio.hpp"

namespace kinship::plots {
namespace {

constexpr double kQuantile90 = 1.6449;  // two-sided, of the normal distribution

bool is_judged(const PlanningRecord& record) {
  return record.sampling_mode != SamplingMode::Uniform && record.outcome != Outcome::Failed;
}

/// Of which planner most judged attempts are; empty if there are none.
std::string commonest_planner(const std::map<std::string, std::uint64_t>& counts) {
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& planner) { return planner.second; });
  return most == counts.end() ? std::string() : most->first;
}

}  // namespace

void add_benefit(const std::vector<const AttemptSummary*>& attempts, const TaskHistory& history,
                 RobotHistory& robot) {
  std::map<std::string, std::uint64_t> planners;
  for (const AttemptSummary* attempt : attempts)
    if (is_judged(attempt->record))
      ++planners[attempt->record.planner];
  robot.planner = commonest_planner(planners);
  evidence::AttemptWindow window;
  Benefit belief;
  std::int64_t bin = 0;
  const auto end_bin = [&] {
    if (std::min(belief.guided, belief.control) < kMinCompared)
      return;
    const evidence::CostRatio ratio = evidence::compare_costs(window.recent());
    if (!ratio.is_compared)
      return;
    belief.time_ms = history.from_ms + (bin + 1) * history.bin_ms;
    belief.ratio = ratio.quantile(0);
    belief.low = ratio.quantile(-kQuantile90);
    belief.high = ratio.quantile(kQuantile90);
    robot.benefit.push_back(belief);
  };
  bool has_news = false;
  for (const AttemptSummary* attempt : attempts) {
    const PlanningRecord& record = attempt->record;
    if (!is_judged(record))
      continue;
    if (record.planner != robot.planner) {
      ++robot.other_planners;
      continue;
    }
    const std::int64_t of_attempt = (attempt->received_ms - history.from_ms) / history.bin_ms;
    if (has_news && of_attempt > bin)
      end_bin();
    bin = of_attempt;
    has_news = true;
    window.add(record.sampling_mode, record.outcome == Outcome::Solved, record.collision_checks);
    ++(record.sampling_mode == SamplingMode::Guided ? belief.guided : belief.control);
  }
  if (has_news)
    end_bin();
}

}  // namespace kinship::plots
