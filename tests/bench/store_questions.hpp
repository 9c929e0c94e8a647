#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "server/store/store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/filled_store.hpp"
#include "tests/bench/measure.hpp"

/// What a server asks its store about one pair, of a large store and of one that has that pair
/// alone.
namespace kinship::bench {

/// What a server asks a store of one pair, by name.
struct Question {
  std::string name;
  std::function<void(const store::Store&)> ask;
};

constexpr std::size_t kPathsOfAPage = 128;  // as a fit reads them

inline void read_all_paths(const store::Store& store, const Pair& pair, std::uint64_t wanted) {
  static_cast<void>(store.experience(pair.task));
  std::uint64_t read = 0;
  for (std::int64_t last = 0;;) {
    const auto page = store.read_paths(pair.robot, pair.task,
                                       {.after_id = last, .limit = kPathsOfAPage, .since_ms = 0});
    if (page.empty())
      break;
    read += page.size();
    last = page.back().id;
  }
  if (read != wanted)
    throw std::runtime_error("paths are missing");
}

/// \param wanted  rows
template <typename Page>
void need(const Page& page, std::size_t wanted) {
  if (page.rows.size() != wanted)
    throw std::runtime_error("rows are missing");
}

inline std::vector<Question> questions(const Fleet& fleet, const FillPlan& plan) {
  const Pair pair = fleet.pairs()[0];
  const Uuid report = fleet.attempt(0, plan.paths_of_pair() / 2).report_uuid;
  const Digest distribution = test::id_from<Digest>(Fleet::distribution_number(0, 3));
  constexpr std::size_t kRows = 100;
  std::vector<Question> asked;
  const auto add = [&asked](std::string name, std::function<void(const store::Store&)> ask) {
    asked.push_back({std::move(name), std::move(ask)});
  };
  add("generation", [=](const store::Store& store) {
    static_cast<void>(store.generation(pair.robot, pair.task));
  });
  add("experience of the task",
      [=](const store::Store& store) { static_cast<void>(store.experience(pair.task)); });
  add("all paths of the pair", [=, wanted = plan.paths_of_pair()](const store::Store& store) {
    read_all_paths(store, pair, wanted);
  });
  add("ids of its paths",
      [=](const store::Store& store) { static_cast<void>(store.path_ids(pair.robot, pair.task)); });
  add("what its attempts cost", [=](const store::Store& store) {
    static_cast<void>(store.attempt_totals(pair.robot, pair.task));
  });
  add("a stored distribution", [=](const store::Store& store) {
    if (!store.find_distribution(distribution))
      throw std::runtime_error("a distribution is missing");
  });
  add("an attempt",
      [=](const store::Store& store) { static_cast<void>(store.find_attempt(report).value()); });
  add("list: a robot", [=](const store::Store& store) { need(store.list_robots("zz", 1), 1); });
  add("list: a task", [=](const store::Store& store) { need(store.list_tasks("", 1), 1); });
  add("show: the task",
      [=](const store::Store& store) { static_cast<void>(store.find_task(pair.task).value()); });
  add("list: 100 of its paths", [=](const store::Store& store) {
    need(store.list_paths(pair.robot, pair.task, "", kRows), kRows);
  });
  add("list: its distributions", [=](const store::Store& store) {
    need(store.list_distributions(pair.robot, pair.task, "", kRows), 10);
  });
  add("export: 100 of its attempts", [=](const store::Store& store) {
    need(store.export_attempts(pair.robot, pair.task, "", kRows, std::size_t{1} << 30U), kRows);
  });
  return asked;
}

/// Each question in turn to both stores, so that the machine's other work meets both.
inline void measure_questions(const std::vector<Question>& asked, const store::Store& large,
                              const store::Store& alone) {
  constexpr int kRounds = 40;
  for (const Question& question : asked) {
    std::vector<double> of_large, of_alone;
    for (int round = 0; round < kRounds; ++round) {
      of_large.push_back(least_s(1, wall_s, [&] { question.ask(large); }));
      of_alone.push_back(least_s(1, wall_s, [&] { question.ask(alone); }));
    }
    print({.name = question.name,
           .value = 1e3 * median(of_large),
           .unit = "ms",
           .reference = Reference{"the pair alone", 1e3 * median(of_alone)},
           .ratio_budget = 1.5});
  }
  std::vector<double> status;
  for (int round = 0; round < kRounds; ++round)
    status.push_back(least_s(1, wall_s, [&] { static_cast<void>(large.status()); }));
  print({.name = "status of the store", .value = 1e3 * median(status), .unit = "ms"});
}

}  // namespace kinship::bench
