// What a season of 200 queries costs a client that chooses between guided and uniform planning,
// against always uniform and always guided planning of the same queries.
// Usage: season_bench plan FILE QUERIES [TASK...]   plans queries in every way, adds to the log
// FILE
//        season_bench play FILE [SEASONS]           plays seasons from the log (default: 20)

#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>

#include "tests/bench/season_play.hpp"

namespace kinship::bench {
namespace {

int plan(const std::string& file, std::size_t queries, std::vector<std::string> tasks) {
  if (tasks.empty())
    tasks = season_task_names();
  std::ofstream log(file, std::ios::app);
  for (const std::string& name : tasks) {
    const std::unique_ptr<SeasonTask> task = make_season_task(name);
    write_log(name, plan_queries(*task, queries, std::cerr), log);
    log.flush();
  }
  return log ? 0 : 1;
}

/// Means of the plans in each way, how many were not solved, and how often the gate fired.
void print_plans(const std::string& task, const std::vector<LoggedQuery>& queries) {
  std::printf("%s, %zu queries\n", task.c_str(), queries.size());
  for (const Guide guide : kGuides) {
    double checks = 0, logs = 0;
    int unsolved = 0, gated = 0;
    for (const LoggedQuery& query : queries) {
      const LoggedPlan& plan = query.at(guide);
      checks += static_cast<double>(plan.checks);
      logs += std::log(static_cast<double>(plan.checks));
      unsolved += plan.solved ? 0 : 1;
      gated += plan.gate_fired ? 1 : 0;
    }
    const auto count = static_cast<double>(queries.size());
    std::printf("  %-12s mean %7.0f checks, geometric %7.0f, %d unsolved, gate fired %d times\n",
                std::string(to_text(guide)).c_str(), checks / count, std::exp(logs / count),
                unsolved, gated);
  }
}

int play(const std::string& file, std::size_t seasons) {
  std::ifstream stream(file);
  for (const auto& [task, queries] : read_log(stream)) {
    print_plans(task, queries);
    std::puts(
        "  case                       always  client  51-200  101-200  / guided  guided  101-200");
    for (const SeasonCase& played : season_cases()) {
      const SeasonOutcome outcome = play_seasons(queries, played, seasons);
      std::printf("  %-26s %6.2f  %6.2f  %6.3f  %7.3f  %8.3f  %5.0f%%  %6.0f%%\n",
                  played.name.c_str(), outcome.all.guided / outcome.all.uniform,
                  outcome.all.against_uniform(), outcome.after_50.against_uniform(),
                  outcome.after_change.against_uniform(), outcome.all.against_guided(),
                  100 * outcome.guided_part, 100 * outcome.guided_part_after_change);
    }
  }
  return 0;
}

int run(const std::vector<std::string>& arguments) {
  const std::size_t count = arguments.size();
  if (count >= 3 && arguments[0] == "plan")
    return plan(arguments[1], std::stoul(arguments[2]), {arguments.begin() + 3, arguments.end()});
  if ((count == 2 || count == 3) && arguments[0] == "play")
    return play(arguments[1], count == 3 ? std::stoul(arguments[2]) : 20);
  std::cerr << "usage: season_bench plan FILE QUERIES [TASK...] | play FILE [SEASONS]\n";
  return 2;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  try {
    return kinship::bench::run({argv + 1, argv + argc});
  } catch (const std::exception& exception) {
    std::cerr << "season_bench: " << exception.what() << '\n';
    return 1;
  }
}
