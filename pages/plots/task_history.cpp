#include "pages/plots/task_history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "proto/evidence/attempt_window.hpp"
#include "proto/evidence/cost_ratio.hpp"

namespace kinship::plots {

namespace {

constexpr std::int64_t kSecond_ms = 1000, kMinute_ms = 60 * kSecond_ms, kHour_ms = 60 * kMinute_ms,
                       kDay_ms = 24 * kHour_ms;
constexpr std::int64_t kLatest_ms = 253'402'300'799'999;  // the end of the year 9999

/// The attempts of one robot and bin while they are gathered.
struct GatheredMode {
  std::vector<double> solved;  ///< their checks
  std::uint64_t unsolved = 0;
};

RobotBin bin_of(std::size_t number, const std::array<GatheredMode, 3>& gathered) {
  RobotBin bin{.bin = number};
  for (std::size_t mode = 0; mode < gathered.size(); ++mode) {
    const GatheredMode& each = gathered[mode];
    ModeCounts& counts = bin.modes[mode];
    counts.solved = each.solved.size();
    counts.attempts = each.solved.size() + each.unsolved;
    if (counts.attempts > 0)
      counts.checks = check_quartiles(each.solved, each.unsolved);
  }
  return bin;
}

/// The attempts of one robot, bin after bin.
RobotHistory robot_history(const std::vector<const AttemptSummary*>& attempts,
                           const TaskHistory& history) {
  RobotHistory robot;
  robot.robot = attempts.front()->robot;
  robot.label = attempts.front()->label;
  std::map<std::size_t, std::array<GatheredMode, 3>> gathered;
  std::map<std::size_t, std::pair<std::uint64_t, std::uint64_t>> reached;  // attempts and paths
  for (const AttemptSummary* attempt : attempts) {
    const PlanningRecord& record = attempt->record;
    const auto number =
        static_cast<std::size_t>((attempt->received_ms - history.from_ms) / history.bin_ms);
    GatheredMode& mode = gathered[number][static_cast<std::size_t>(record.sampling_mode)];
    ++robot.attempts;
    if (record.outcome == Outcome::Solved) {
      ++robot.solved;
      mode.solved.push_back(static_cast<double>(record.collision_checks));
    } else if (record.outcome == Outcome::Timeout) {
      ++robot.unsolved;
      ++mode.unsolved;
    } else {
      ++robot.not_planned;
    }
    reached[number] = {robot.attempts, robot.solved};
  }
  for (const auto& [number, modes] : gathered) {
    robot.bins.push_back(bin_of(number, modes));
    std::tie(robot.bins.back().attempts, robot.bins.back().paths) = reached.at(number);
  }
  add_benefit(attempts, history, robot);
  return robot;
}

std::vector<Revision> revisions_of(const std::vector<AttemptSummary>& attempts,
                                   const std::vector<DistributionSummary>& distributions) {
  std::map<std::pair<Digest, std::uint64_t>, Revision> revisions;
  for (const AttemptSummary& attempt : attempts) {
    if (!attempt.record.distribution_id)
      continue;
    const std::pair key(*attempt.record.distribution_id, attempt.record.distribution_revision);
    Revision& revision = revisions
                             .try_emplace(key, Revision{key.first, key.second, attempt.label, 0,
                                                        attempt.received_ms, 0})
                             .first->second;
    ++revision.attempts;
  }
  for (const DistributionSummary& kept : distributions) {
    Revision& revision =
        revisions
            .try_emplace({kept.id, kept.revision}, Revision{kept.id, kept.revision, kept.label})
            .first->second;
    revision.fitted_ms = kept.fitted_ms;
  }
  std::vector<Revision> sorted;
  for (auto& [key, revision] : revisions)
    sorted.push_back(std::move(revision));
  std::ranges::stable_sort(sorted, {}, [](const Revision& revision) {
    return revision.fitted_ms > 0 ? revision.fitted_ms : revision.first_ms;
  });
  return sorted;
}

}  // namespace

CheckQuartiles check_quartiles(std::vector<double> solved, std::uint64_t unsolved) {
  std::ranges::sort(solved);
  const std::size_t count = solved.size() + unsolved;
  const auto quantile = [&](double part) -> std::optional<double> {
    const double place = part * static_cast<double>(count - 1);
    const auto below = static_cast<std::size_t>(std::floor(place));
    const auto above = static_cast<std::size_t>(std::ceil(place));
    if (above >= solved.size())
      return std::nullopt;
    const double weight = place - static_cast<double>(below);
    return (1 - weight) * solved[below] + weight * solved[above];
  };
  constexpr double kLower = 0.25, kMedian = 0.5, kUpper = 0.75;
  return {quantile(kLower), quantile(kMedian), quantile(kUpper)};
}

std::int64_t bin_length_ms(std::int64_t first_ms, std::int64_t last_ms) {
  constexpr std::array kLengths_ms = {
      kSecond_ms,      5 * kSecond_ms, 15 * kSecond_ms, kMinute_ms, 5 * kMinute_ms,
      15 * kMinute_ms, kHour_ms,       6 * kHour_ms,    kDay_ms,    7 * kDay_ms};
  for (const std::int64_t length : kLengths_ms)
    if (last_ms / length - first_ms / length < static_cast<std::int64_t>(kMaxBins))
      return length;
  constexpr std::int64_t kWeeks = 4;
  std::int64_t length = kWeeks * kLengths_ms.back();
  while (last_ms / length - first_ms / length >= static_cast<std::int64_t>(kMaxBins))
    length *= 2;
  return length;
}

TaskHistory history_of(const std::string& task, std::vector<AttemptSummary> attempts,
                       const std::vector<DistributionSummary>& distributions) {
  if (attempts.empty())
    throw std::invalid_argument("history_of: no attempt");
  for (AttemptSummary& attempt : attempts)  // a server may say anything
    attempt.received_ms = std::clamp<std::int64_t>(attempt.received_ms, 0, kLatest_ms);
  const auto [first, last] = std::ranges::minmax(attempts, {}, &AttemptSummary::received_ms);
  TaskHistory history;
  history.task = task;
  history.bin_ms = bin_length_ms(first.received_ms, last.received_ms);
  history.from_ms = first.received_ms / history.bin_ms * history.bin_ms;
  history.bins =
      static_cast<std::size_t>((last.received_ms - history.from_ms) / history.bin_ms) + 1;
  std::map<Digest, std::vector<const AttemptSummary*>> by_robot;
  for (const AttemptSummary& attempt : attempts)
    by_robot[attempt.robot].push_back(&attempt);
  for (auto& [robot, own] : by_robot) {
    std::ranges::stable_sort(own, {}, &AttemptSummary::received_ms);  // a clock may go back
    history.robots.push_back(robot_history(own, history));
  }
  std::ranges::sort(history.robots, {}, &RobotHistory::label);
  history.revisions = revisions_of(attempts, distributions);
  return history;
}

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
    window.add(record.sampling_mode, record.outcome == Outcome::Solved, record.collision_checks,
               record.processor_time_s * record.machine_speed);
    ++(record.sampling_mode == SamplingMode::Guided ? belief.guided : belief.control);
  }
  if (has_news)
    end_bin();
}

}  // namespace kinship::plots
