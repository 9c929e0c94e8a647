#include "server/console/recent_attempts.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <map>
#include <utility>

#include "pages/page/json_text.hpp"
#include "proto/evidence/attempt_window.hpp"
#include "proto/evidence/cost_ratio.hpp"
#include "proto/types/attempt_filter.hpp"

namespace kinship::console {
namespace {

using page::json_string;
using page::number;

constexpr double kMaxHours = 24 * 366;      // of the past
constexpr std::uint64_t kMinCompared = 10;  // attempts of either mode

struct RecentAttempts {
  std::int64_t since_ms = 0;
  bool is_whole = true;
  std::vector<AttemptSummary> attempts;  // the newest first
};

RecentAttempts read_recent(Questions& questions, const std::string& hours_text) {
  double hours = 24;
  std::from_chars(hours_text.data(), hours_text.data() + hours_text.size(), hours);
  hours = std::clamp(hours, 0.0, kMaxHours);
  using std::chrono::milliseconds;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  RecentAttempts recent;
  recent.since_ms = std::chrono::duration_cast<milliseconds>(now).count() -
                    static_cast<std::int64_t>(hours * 3.6e6);
  AttemptFilter filter;
  filter.since_ms = recent.since_ms;
  recent.attempts = questions.rows<AttemptSummary>(
      {.verb = AdminVerb::FindAttempts, .argument = to_text(filter)}, kMaxRecentAttempts);
  recent.is_whole = recent.attempts.size() < kMaxRecentAttempts;
  return recent;
}

/// Of everything, on a machine of speed 1 where that is known, s.
double time_of(const PlanningRecord& record) {
  if (record.processor_time_s <= 0)
    return record.planning_time_s;
  return record.processor_time_s * (record.machine_speed > 0 ? record.machine_speed : 1);
}

using PairName = std::pair<std::string, std::string>;  // task, label of the robot

PairName pair_of(const AttemptSummary& attempt) { return {attempt.task, attempt.label}; }

struct PairCost {
  std::uint64_t attempts = 0, unsolved = 0;
  double time_s = 0;
};

std::string json_of(const std::pair<const PairName, PairCost>& pair) {
  return page::object({{"task", json_string(pair.first.first)},
                       {"robot", json_string(pair.first.second)},
                       {"attempts", std::to_string(pair.second.attempts)},
                       {"unsolved", std::to_string(pair.second.unsolved)},
                       {"time_s", number(pair.second.time_s)}});
}

/// What the attempts of a robot and task tell of guidance.
struct PairSavings {
  std::uint64_t guided = 0, control = 0;
  double guided_s = 0, control_s = 0;
  evidence::AttemptWindow window;

  void add(const PlanningRecord& record) {
    const bool is_guided = record.sampling_mode == SamplingMode::Guided;
    if (record.outcome == Outcome::Failed || record.sampling_mode == SamplingMode::Uniform)
      return;
    const double time_s = time_of(record);
    ++(is_guided ? guided : control);
    (is_guided ? guided_s : control_s) += time_s;
    window.add(record.sampling_mode, record.outcome == Outcome::Solved, record.collision_checks,
               record.processor_time_s > 0 ? time_s : 0);
  }
};

std::string json_of(const std::pair<const PairName, PairSavings>& pair) {
  constexpr double kDeviates = 1.645;  // of a 90 % interval
  const PairSavings& savings = pair.second;
  std::string ratio = "null", low = "null", high = "null", saved = "null";
  if (savings.guided >= kMinCompared && savings.control >= kMinCompared) {
    const evidence::CostRatio compared = evidence::compare_costs(savings.window.recent());
    ratio = number(compared.quantile(0));
    low = number(compared.quantile(-kDeviates));
    high = number(compared.quantile(kDeviates));
    const auto guided = static_cast<double>(savings.guided);
    saved = number(guided * savings.control_s / static_cast<double>(savings.control) -
                   savings.guided_s);
  }
  return page::object({{"task", json_string(pair.first.first)},
                       {"robot", json_string(pair.first.second)},
                       {"guided", std::to_string(savings.guided)},
                       {"control", std::to_string(savings.control)},
                       {"ratio", ratio},
                       {"low", low},
                       {"high", high},
                       {"saved_s", saved}});
}

template <typename Value>
std::string json_of_all(const std::map<PairName, Value>& pairs) {
  return page::list(pairs, [](const auto& pair) { return json_of(pair); });
}

}  // namespace

std::string slow_figure(Questions& questions, const std::string& hours) {
  const RecentAttempts recent = read_recent(questions, hours);
  std::map<PairName, PairCost> pairs;
  for (const AttemptSummary& attempt : recent.attempts) {
    PairCost& pair = pairs[pair_of(attempt)];
    ++pair.attempts;
    pair.unsolved += attempt.record.outcome == Outcome::Solved ? 0 : 1;
    pair.time_s += time_of(attempt.record);
  }
  return page::object({{"since_ms", std::to_string(recent.since_ms)},
                       {"attempts", std::to_string(recent.attempts.size())},
                       {"is_whole", recent.is_whole ? "true" : "false"},
                       {"pairs", json_of_all(pairs)}});
}

std::string savings_figure(Questions& questions, const std::string& hours) {
  const RecentAttempts recent = read_recent(questions, hours);
  std::map<PairName, PairSavings> pairs;
  for (auto attempt = recent.attempts.rbegin(); attempt != recent.attempts.rend(); ++attempt)
    pairs[pair_of(*attempt)].add(attempt->record);  // in the order of arrival
  std::erase_if(pairs, [](const auto& pair) { return pair.second.guided == 0; });
  return page::object({{"since_ms", std::to_string(recent.since_ms)},
                       {"attempts", std::to_string(recent.attempts.size())},
                       {"is_whole", recent.is_whole ? "true" : "false"},
                       {"pairs", json_of_all(pairs)}});
}

}  // namespace kinship::console
