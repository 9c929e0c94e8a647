#include "tests/bench/season_logs.hpp"

#include <istream>
#include <numbers>
#include <ostream>
#include <random>
#include <sstream>
#include <stdexcept>

#include "client/planning/birrt.hpp"
#include "client/planning/guidance_gate.hpp"
#include "client/planning/planning_bounds.hpp"
#include "client/planning/shortcut.hpp"
#include "server/density/fit.hpp"
#include "tests/support/transfer_path.hpp"

namespace kinship::bench {
namespace {

constexpr std::size_t kLearningPaths = 30;
constexpr std::uint64_t kFirstLearning = 1'000'000;  // learning queries are others than test ones
constexpr double kShare = 0.9;
constexpr double kTurn = 2 * std::numbers::pi;

planning::PlanSummary plan(const SeasonTask& task, SeasonQuery& query,
                           const planning::ConfigurationSampler& sampler, std::uint64_t seed) {
  planning::BirrtOptions options;
  options.step = task.planner.step;
  options.overshoot = task.planner.overshoot;
  options.max_checks = task.planner.cap;
  options.time_limit = std::chrono::hours(1);  // checks end a query, not the machine's load
  std::mt19937_64 generator(seed);
  return planning::plan_birrt(
      query.start, query.goals, [&](const Eigen::VectorXd& q) { return !query.world.collides(q); },
      sampler, options, generator);
}

std::vector<Path> learn(const SeasonTask& task) {
  std::vector<Path> paths;
  for (std::uint64_t number = kFirstLearning; paths.size() < kLearningPaths; ++number) {
    auto query = task.make_query(number);
    if (!query)
      continue;
    const planning::ConfigurationSampler uniform(
        planning::planning_bounds(task.chain, query->start));
    const planning::PlanSummary found = plan(task, *query, uniform, number);
    if (!found.waypoints)
      continue;
    std::mt19937_64 generator(number);
    const auto is_free = [&](const Eigen::VectorXd& q) { return !query->world.collides(q); };
    paths.emplace_back(
        planning::shortcut(*found.waypoints, is_free, {.step = task.planner.step}, generator)
            .waypoints);
  }
  return paths;
}

/// What is done to the learned configurations of a path, in order, before the fit.
using Spoil = void (*)(Eigen::MatrixXd& configurations);

void spoil_nothing(Eigen::MatrixXd&) {}

void turn(Eigen::MatrixXd& configurations, Eigen::Index from, Eigen::Index to) {
  for (Eigen::Index i = from; i < to; ++i)
    configurations(0, i) = std::remainder(configurations(0, i) + std::numbers::pi, kTurn);
}

void turn_all(Eigen::MatrixXd& configurations) { turn(configurations, 0, configurations.cols()); }

void turn_middle(Eigen::MatrixXd& configurations) {
  const Eigen::Index end = configurations.cols() / 5;
  turn(configurations, end, configurations.cols() - end);
}

Mixture fit(const SeasonTask& task, const std::vector<Path>& paths, Spoil spoil) {
  const transfer::ArmPair pair(task.chain, task.chain);
  const Profile profile = *find_profile("default");
  Eigen::MatrixXd configurations(task.chain.dof(), 0);
  Eigen::VectorXd weights;
  for (const Path& path : paths) {
    transfer::TransferredPath moved = test::transfer_path(path, pair, Eigen::Isometry3d::Identity(),
                                                          profile.transfer, profile.seed);
    const Eigen::Index count = moved.configurations.cols(), before = configurations.cols();
    if (count == 0)
      continue;
    spoil(moved.configurations);
    configurations.conservativeResize(Eigen::NoChange, before + count);
    configurations.rightCols(count) = moved.configurations;
    weights.conservativeResize(before + count);
    weights.tail(count).setConstant(1.0 / static_cast<double>(count));
  }
  return density::fit_mixture(configurations, weights,
                              {.components = profile.density.components,
                               .covariance_floor = profile.density.covariance_floor})
      .value_or_throw()
      .mixture;
}

/// Plans queries of one task in every way.
class Ways {
 public:
  explicit Ways(const SeasonTask& task) : task_(task), paths_(learn(task)) {
    mixtures_.emplace(Guide::Good, fit(task, paths_, spoil_nothing));
    mixtures_.emplace(Guide::Turned, fit(task, paths_, turn_all));
    mixtures_.emplace(Guide::Open, mixtures_.at(Guide::Turned));
    mixtures_.emplace(Guide::Misleading, fit(task, paths_, turn_middle));
  }

  LoggedPlan plan_one(SeasonQuery& query, Guide guide, std::uint64_t seed) const {
    const Eigen::Matrix2Xd bounds = planning::planning_bounds(task_.chain, query.start);
    LoggedPlan logged;
    planning::ConfigurationSampler sampler(bounds);
    if (guide != Guide::None) {
      const Mixture& mixture = mixtures_.at(guide);
      logged.gate_fired = guide != Guide::Open &&
                          planning::query_distance(task_.chain, mixture, query.start, query.goals)
                              .is_beyond(planning::kGateDistance);
      if (!logged.gate_fired)
        sampler = planning::ConfigurationSampler(bounds, task_.chain, mixture, kShare);
    }
    const planning::PlanSummary summary = plan(task_, query, sampler, seed);
    logged.checks = summary.collision_checks;
    logged.solved = summary.waypoints.has_value();
    return logged;
  }

 private:
  const SeasonTask& task_;
  std::vector<Path> paths_;
  std::map<Guide, Mixture> mixtures_;
};

}  // namespace

std::string_view to_text(Guide guide) {
  switch (guide) {
    case Guide::None:
      return "none";
    case Guide::Good:
      return "good";
    case Guide::Turned:
      return "turned";
    case Guide::Open:
      return "open";
    case Guide::Misleading:
      return "misleading";
  }
  return "";
}

std::vector<LoggedQuery> plan_queries(const SeasonTask& task, std::size_t queries,
                                      std::ostream& messages) {
  const Ways ways(task);
  std::vector<LoggedQuery> logged;
  for (std::uint64_t number = 0; logged.size() < queries; ++number) {
    auto query = task.make_query(number);
    if (!query)
      continue;
    LoggedQuery one;
    for (const Guide guide : kGuides)
      one[guide] = ways.plan_one(*query, guide, number);
    logged.push_back(std::move(one));
    if (logged.size() % 50 == 0)
      messages << task.name << ": " << logged.size() << " of " << queries << " queries planned\n";
  }
  return logged;
}

void write_log(const std::string& task, const std::vector<LoggedQuery>& queries,
               std::ostream& stream) {
  for (std::size_t i = 0; i < queries.size(); ++i)
    for (const auto& [guide, plan] : queries[i])
      stream << task << ',' << i << ',' << to_text(guide) << ',' << plan.checks << ','
             << plan.solved << ',' << plan.gate_fired << '\n';
}

std::map<std::string, std::vector<LoggedQuery>> read_log(std::istream& stream) {
  std::map<std::string, std::vector<LoggedQuery>> logs;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    std::string task, number, guide, checks, solved, gate;
    for (std::string* field : {&task, &number, &guide, &checks, &solved, &gate})
      std::getline(fields, *field, ',');
    std::vector<LoggedQuery>& queries = logs[task];
    const std::size_t index = std::stoul(number);
    if (index >= queries.size())
      queries.resize(index + 1);
    bool known = false;
    for (const Guide each : kGuides)
      if (to_text(each) == guide) {
        queries[index][each] = {std::stoul(checks), solved == "1", gate == "1"};
        known = true;
      }
    if (!known)
      throw std::runtime_error("season log: '" + line + "'");
  }
  return logs;
}

}  // namespace kinship::bench
