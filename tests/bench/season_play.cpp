#include "tests/bench/season_play.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>

#include "client/planning/arm_choice.hpp"

namespace kinship::bench {
namespace {

void count(SeasonScore& score, const LoggedPlan& client, const LoggedPlan& uniform,
           const LoggedPlan& guided) {
  score.client += static_cast<double>(client.checks);
  score.uniform += static_cast<double>(uniform.checks);
  score.guided += static_cast<double>(guided.checks);
}

/// One season of one client that begins without evidence; adds to the sums.
void play(const std::vector<const LoggedQuery*>& queries, const SeasonCase& played,
          std::mt19937_64& generator, SeasonOutcome& outcome) {
  planning::ArmChooser chooser({}, {});
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const LoggedPlan& uniform = queries[i]->at(Guide::None);
    const LoggedPlan& guided = queries[i]->at(i < kChange ? played.first : played.second);
    const Arm arm = chooser.choose(generator());
    const LoggedPlan& client = arm == Arm::Guided ? guided : uniform;
    chooser.add(arm, client.solved ? Outcome::Solved : Outcome::Timeout, client.checks);
    count(outcome.all, client, uniform, guided);
    if (i >= 50)
      count(outcome.after_50, client, uniform, guided);
    outcome.guided_part += arm == Arm::Guided ? 1 : 0;
    if (i < kChange)
      continue;
    count(outcome.after_change, client, uniform, guided);
    outcome.guided_part_after_change += arm == Arm::Guided ? 1 : 0;
  }
}

}  // namespace

std::vector<SeasonCase> season_cases() {
  std::vector<SeasonCase> cases = {{"good", Guide::Good, Guide::Good}};
  for (const Guide wrong : {Guide::Turned, Guide::Open, Guide::Misleading}) {
    const std::string name(to_text(wrong));
    cases.push_back({name, wrong, wrong});
    cases.push_back({"good, then " + name, Guide::Good, wrong});
    cases.push_back({name + ", then good", wrong, Guide::Good});
  }
  return cases;
}

SeasonOutcome play_seasons(const std::vector<LoggedQuery>& log, const SeasonCase& played,
                           std::size_t seasons) {
  if (log.size() < kSeasonQueries)
    throw std::invalid_argument("play_seasons: " + std::to_string(log.size()) +
                                " queries in the log, need " + std::to_string(kSeasonQueries));
  std::mt19937_64 generator(seasons);
  std::vector<std::size_t> order(log.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  SeasonOutcome outcome;
  for (std::size_t season = 0; season < seasons; ++season) {
    std::shuffle(order.begin(), order.end(), generator);
    std::vector<const LoggedQuery*> queries;
    for (std::size_t i = 0; i < kSeasonQueries; ++i)
      queries.push_back(&log[order[i]]);
    play(queries, played, generator, outcome);
  }
  const auto count_of_seasons = static_cast<double>(seasons);
  outcome.guided_part /= count_of_seasons * kSeasonQueries;
  outcome.guided_part_after_change /= count_of_seasons * (kSeasonQueries - kChange);
  return outcome;
}

}  // namespace kinship::bench
