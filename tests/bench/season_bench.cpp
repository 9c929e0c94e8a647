// What a season of queries costs a client that begins without evidence and chooses between guided
// and uniform planning as it goes. No planning: checks are drawn, log-normal about the means and
// medians of a shelf task (uniform 4299 and 2726, guided 2938 and 1810) times what the case says.

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "client/guided/sampling_mode_choice.hpp"
#include "robots/planning/planning_budget.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/processor.hpp"

namespace kinship::bench {
namespace {

constexpr int kQueries = 400;
constexpr int kChange = kQueries / 2;  // queries before something changes
constexpr int kSeasons = 50;
constexpr double kUniformChecks = 4299;

/// Uniform / guided before and after the change, and how much dearer the task gets with it.
struct Season {
  std::string name;
  double ratio = 1;
  double ratio_after = 1;
  double dearer = 1;
  bool has_absurd_report = false;
};

const std::vector<Season> kCases = {{"ratio 3.3", 3.3, 3.3},
                                    {"ratio 1.43", 1.43, 1.43},
                                    {"ratio 1", 1, 1},
                                    {"ratio 0.67", 0.67, 0.67},
                                    {"ratio 0.33", 0.33, 0.33},
                                    {"ratio 1.43, the task 4 x dearer", 1.43, 1.43, 4},
                                    {"ratio 1.43, an absurd report", 1.43, 1.43, 1, true},
                                    {"ratio 3.3, then 0.33", 3.3, 0.33},
                                    {"ratio 1.43, then 0.67", 1.43, 0.67},
                                    {"ratio 0.33, then 3.3", 0.33, 3.3}};

std::uint64_t draw(bool is_guided, double mean, std::mt19937_64& generator) {
  const double mean_to_median = is_guided ? 2938.0 / 1810 : 4299.0 / 2726;
  std::lognormal_distribution<double> checks(std::log(mean / mean_to_median),
                                             std::sqrt(2 * std::log(mean_to_median)));
  return static_cast<std::uint64_t>(checks(generator)) + 1;
}

/// Expected checks over all seasons, as parts of those of uniform planning.
struct SeasonOutcome {
  double all = 0, after_change = 0, guided_after_change = 0;
};

SeasonOutcome play(const Season& season) {
  double uniform = 0, uniform_after = 0;
  SeasonOutcome outcome;
  for (std::uint64_t seed = 1; seed <= kSeasons; ++seed) {
    std::mt19937_64 generator(seed);
    guided::SamplingModeChooser chooser({}, {});
    for (int i = 0; i < kQueries; ++i) {
      const bool is_after = i >= kChange;
      const SamplingMode mode = chooser.choose(generator());
      const bool is_guided = mode == SamplingMode::Guided;
      const double usual = kUniformChecks * (is_after ? season.dearer : 1);
      const double mean = usual / (is_guided ? is_after ? season.ratio_after : season.ratio : 1);
      chooser.add(mode, Outcome::Solved, draw(is_guided, mean, generator));
      if (season.has_absurd_report && i == kChange)
        chooser.add(SamplingMode::Guided, Outcome::Solved, 9'000'000'000'000'000'000);
      outcome.all += mean;
      uniform += usual;
      outcome.after_change += is_after ? mean : 0;
      uniform_after += is_after ? usual : 0;
      outcome.guided_after_change += is_after && is_guided ? 1 : 0;
    }
  }
  return {outcome.all / uniform, outcome.after_change / uniform_after,
          outcome.guided_after_change / (kSeasons * (kQueries - kChange))};
}

/// What the choice costs a query, us of processor time, with all evidence there can be.
/// \param slower  guided / uniform, of the time of a plan, 0.3 ms.
double choice_us(double slower) {
  constexpr int kChoices = 20'000, kBefore = 1000;
  std::mt19937_64 generator(1);
  std::lognormal_distribution<double> time_s(std::log(0.3e-3), 0.7);
  std::vector<double> times_s(kBefore + kChoices);
  for (double& each : times_s)
    each = time_s(generator);
  guided::SamplingModeChooser chooser({}, {});
  double begin_s = 0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (i == kBefore)
      begin_s = planning::thread_time_s();
    const SamplingMode mode = chooser.choose(i);
    chooser.add(mode, Outcome::Solved, 1000,
                times_s[i] * (mode == SamplingMode::Guided ? slower : 1));
  }
  return (planning::thread_time_s() - begin_s) / kChoices * 1e6;
}

}  // namespace
}  // namespace kinship::bench

int main() {
  using kinship::bench::Better;
  for (const auto& [name, slower] : {std::pair{"3", 3.0}, {"1", 1.0}, {"0.3", 0.3}})
    kinship::bench::print({.name = "choice, guided plans " + std::string(name) + " x as long",
                           .value = kinship::bench::choice_us(slower),
                           .unit = "us a query",
                           .better = Better::Lower,
                           .reference = kinship::bench::time_at_best(140e3, 1e-6),
                           .ratio_budget = 1});
  for (const auto& season : kinship::bench::kCases) {
    const auto outcome = kinship::bench::play(season);
    kinship::bench::print({.name = season.name,
                           .value = outcome.all,
                           .unit = "of uniform planning's checks",
                           .better = Better::Lower});
    kinship::bench::print({.name = season.name + ", second half",
                           .value = outcome.after_change,
                           .unit = "of uniform planning's checks",
                           .better = Better::Lower});
    kinship::bench::print({.name = season.name + ", guided in the second half",
                           .value = outcome.guided_after_change,
                           .unit = "of the queries",
                           .better = outcome.after_change < 1 ? Better::Higher : Better::Lower});
  }
}
