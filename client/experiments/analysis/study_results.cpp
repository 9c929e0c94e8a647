#include "client/experiments/analysis/study_results.hpp"

#include <algorithm>

#include "client/experiments/analysis/ratio_table.hpp"
#include "client/experiments/statistics.hpp"

namespace kinship::experiments {

StudyResults::StudyResults(const Study& study, const std::vector<QueryResult>& results)
    : uniform_(uniform_name(study.settings.overshoot)) {
  for (const StudyRobot& robot : study.robots)
    robots_.push_back(robot.model);
  std::vector<std::string> guidances = robots_;
  guidances.push_back(uniform_);
  if (uniform_ != uniform_name(1))
    guidances.push_back(uniform_name(1));
  for (const std::string& robot : robots_)
    for (const std::string& guidance : guidances) {
      CellResults cell = collect_cell(results, robot, guidance, study.settings.max_checks);
      if (!cell.instances.empty())
        cells_.emplace(Key(robot, guidance), std::move(cell));
    }
  for (const std::string& robot : robots_)
    for (const std::string& source : robots_) {
      const CellResults* const uniform = find(robot, uniform_);
      const CellResults* const guided = find(robot, source);
      if (uniform != nullptr && guided != nullptr)
        pairs_.emplace(Key(robot, source), compare_cells(*uniform, *guided));
    }
}

const CellResults* StudyResults::find(const std::string& robot, const std::string& guidance) const {
  const auto known = cells_.find({robot, guidance});
  return known == cells_.end() ? nullptr : &known->second;
}

const PairRatio* StudyResults::find_pair(const std::string& robot,
                                         const std::string& source) const {
  const auto known = pairs_.find({robot, source});
  return known == pairs_.end() ? nullptr : &known->second;
}

double StudyResults::ratio_to_better_uniform(const std::string& robot,
                                             const std::string& source) const {
  const auto mean_checks = [&](const std::string& guidance) {
    return mean(flat(cells_.at({robot, guidance}).checks));
  };
  double uniform = mean_checks(uniform_);
  if (find(robot, uniform_name(1)) != nullptr)
    uniform = std::min(uniform, mean_checks(uniform_name(1)));
  return uniform / mean_checks(source);
}

GeometricMean StudyResults::geometric_mean(Pairs pairs, Quantity quantity) const {
  std::vector<std::pair<const CellResults*, const CellResults*>> chosen;
  for (const auto& [key, pair] : pairs_) {
    const bool is_own = key.first == key.second;
    if (pairs == Pairs::All || is_own == (pairs == Pairs::Own))
      chosen.emplace_back(find(key.first, uniform_), find(key.first, key.second));
  }
  return geometric_mean_ratio(chosen, quantity);
}

}  // namespace kinship::experiments
