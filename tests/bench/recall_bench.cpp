// What recalled paths are worth, in CPU time of one thread with everything a query costs: goal
// configurations, preparation, search. Beside it uniform planning, and the retreat, which needs no
// experience; both by the same steps.
//
//   recall_bench STUDY|DIR [ROBOT...] [--set tuning|test] [--uniform] [--kind KIND]
//
// DIR: problem files of one's own (problem_files.hpp).
// --uniform: uniform planning alone: how dear a study is.
//
// own: the robot's own learning instances, solved uniformly. first day: the learning instances of
// another robot, the next one of the study, of which it knows scenes and the hand at start and
// goal; it begins where it usually begins, or with its hand where the other's was if that is not
// free. Where no path is free, the retreat plans.

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "client/experiments/studies/fleet.hpp"
#include "client/experiments/studies/study.hpp"
#include "client/guided/path_measures.hpp"
#include "client/guided/plan_problem.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/guided_sampler.hpp"
#include "robots/planning/region_constraint.hpp"
#include "robots/planning/shortcut.hpp"
#include "robots/recall/library_maker.hpp"
#include "robots/recall/recall.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/problem_sets.hpp"
#include "tests/support/places.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeeds = 2;

struct Robot {
  models::LoadedRobot loaded;
  guided::PlannedRobot planned;
  experiments::DrawInstance draw;
};

/// A query with its world.
struct Item {
  Item(const Robot& robot, Problem its_problem, double its_step)
      : problem(std::move(its_problem)),
        step(its_step),
        T_task_base(problem.T_task_base.value_or(Eigen::Isometry3d::Identity())),
        surroundings{T_task_base, problem.scene, problem.attached, problem.allowed_collisions},
        world(robot.planned.solids, surroundings),
        is_free(planning::free_in(world)),
        bounds(planning::planning_bounds(robot.planned.chain, problem.start)) {
    if (problem.constraint)
      constraint.emplace(robot.planned.chain, *problem.constraint, T_task_base, bounds);
  }

  Eigen::MatrixXd find_goals(const Robot& robot, int most) {
    if (!problem.T_task_goal)
      return problem.goal_configurations;
    planning::GoalOptions options;
    options.max_configurations = most;
    options.seed = problem.seed;
    return planning::goal_configurations(robot.planned.chain, robot.planned.solver,
                                         T_task_base.inverse() * *problem.T_task_goal, bounds,
                                         is_free, options)
        .configurations;
  }

  Problem problem;
  double step;
  Eigen::Isometry3d T_task_base;
  collision::Surroundings surroundings;
  collision::CollisionWorld world;
  planning::IsFree is_free;
  Eigen::Matrix2Xd bounds;
  std::optional<planning::RegionConstraint> constraint;
};

/// What planning cost, and the paths, query by query.
struct Costs {
  std::vector<double> checks, time_s;
  std::vector<ProblemResult> paths;  // measured; without measures if unsolved
  int solved = 0;
};

class Queries {
 public:
  Queries(const Robot& robot, const experiments::Study& study) : robot_(robot), study_(study) {}

  /// \param failed  by recall, to be followed too.
  planning::PlanSummary search(Item& item, Guide guide, std::uint64_t seed,
                               std::vector<recall::Warp> failed = {}) const {
    const Eigen::MatrixXd goals = item.find_goals(robot_, study_.settings.max_goals);
    planning::BirrtOptions options;
    options.step = study_.settings.resolution;
    options.overshoot = study_.settings.overshoot;
    options.max_checks = study_.settings.max_checks;
    options.time_limit = std::chrono::seconds(600);
    std::mt19937_64 generator(seed);
    const planning::TrackQuery query{
        item.T_task_base, item.bounds, item.problem.start, goals, {}, [&failed] {
          return recall::whole(failed);
        }};
    const auto sampler =
        planning::guided_sampler(robot_.planned.chain, query, nullptr, nothing_, {.guide = guide})
            .sampler;
    return planning::plan_trees(item.problem.start, goals,
                                {item.is_free, item.constraint ? &*item.constraint : nullptr},
                                sampler, options, generator);
  }

  recall::RecallSummary recall(Item& item, const recall::RecallGuide& guide) const {
    recall::Query query;
    query.T_task_base = item.T_task_base;
    query.bounds = item.bounds;
    query.start = item.problem.start;
    if (item.problem.T_task_goal)
      query.T_base_goal = item.T_task_base.inverse() * *item.problem.T_task_goal;
    else
      query.goals = item.problem.goal_configurations;
    query.constraint = item.constraint ? &*item.constraint : nullptr;
    query.T_task_anchors =
        recall::find_anchors(guide.library().anchors, item.problem.scene.objects);
    return recall::recall(guide, query, item.is_free, {.step = study_.settings.resolution});
  }

 private:
  const Robot& robot_;
  const experiments::Study& study_;
  std::shared_ptr<const planning::ExperienceGuide> nothing_ =
      std::make_shared<planning::ExperienceGuide>(robot_.planned.chain, TaskExperience{});
};

Uuid uuid_of(std::size_t index) {
  Uuid uuid{};
  uuid.bytes[0] = 1;
  uuid.bytes[14] = static_cast<std::uint8_t>(index >> 8U);
  uuid.bytes[15] = static_cast<std::uint8_t>(index);
  return uuid;
}

/// A record that another robot told: where the usual start is not free, with the hand where that
/// robot's began.
Problem with_free_start(const Robot& robot, const experiments::Study& study, Problem record) {
  Item item(robot, record, study.settings.resolution);
  if (!record.T_task_start || item.is_free(record.start))
    return record;
  const auto found = planning::start_configuration(
      robot.planned.chain, robot.planned.solver, item.T_task_base.inverse() * *record.T_task_start,
      record.goal_configurations, item.is_free);
  if (found.q)
    record.start = *found.q;
  return record;
}

/// \param records  problems, of this robot or another one that solved them
std::optional<RecallLibrary> make_library(const Robot& robot, const experiments::Study& study,
                                          const std::vector<Problem>& records, bool is_own) {
  std::vector<recall::PosedQuery> posed;
  const Queries queries(robot, study);
  for (std::size_t i = 0; i < records.size(); ++i) {
    Item item(robot, with_free_start(robot, study, records[i]), study.settings.resolution);
    recall::PosedQuery query{uuid_of(i),         {}, item.surroundings, item.bounds,
                             item.problem.start, {}};
    query.goals = item.find_goals(robot, study.settings.max_goals);
    query.constraint = records[i].constraint;
    if (query.goals.cols() == 0 || !item.is_free(query.start))
      continue;
    if (is_own)
      if (const auto found = queries.search(item, Guide::None, records[i].seed); found.waypoints)
        query.solution = found.waypoints;
    posed.push_back(std::move(query));
  }
  recall::LibraryMakerOptions options;
  options.step = study.settings.resolution;
  recall::LibraryMaker maker(robot.planned.chain, robot.planned.solids, std::move(posed), options);
  while (maker.step()) {
  }
  return maker.take();
}

/// Costs of planning each query uniformly, by the retreat, and with recall.
struct Compared {
  Costs uniform, retreat, recalled;
  int hits = 0;
  std::uint64_t tries = 0;
  double hit_s = 0, expected = 0, made_s = 0;
};

void print_as(const std::string& name, const RecallLibrary& library, const Compared& compared);

/// What planning costs, whatever it is guided by.
void add_costs(const Robot& robot, Item& item, Costs& costs,
               const std::function<std::optional<Eigen::MatrixXd>()>& plan) {
  const std::uint64_t before = item.world.checks();
  const double from_s = thread_cpu_s();
  ProblemResult path;
  path.waypoints = plan();
  costs.time_s.push_back(thread_cpu_s() - from_s);
  costs.checks.push_back(static_cast<double>(item.world.checks() - before));
  costs.solved += path.waypoints ? 1 : 0;
  guided::measure_path(robot.planned, item.problem, path);
  path.waypoints.reset();
  costs.paths.push_back(std::move(path));
}

void compare(const Robot& robot, const experiments::Study& study, const std::string& name,
             const std::vector<Problem>& records, const std::vector<Problem>& tests, bool is_own) {
  Compared compared;
  const double begin_s = thread_cpu_s();
  const auto library = make_library(robot, study, records, is_own);
  compared.made_s = thread_cpu_s() - begin_s;
  if (!library) {
    std::cerr << name << ": no library\n";
    return;
  }
  const recall::RecallGuide guide(robot.planned.chain, *library);
  const Queries queries(robot, study);
  const Guide fallback = Guide::Retreat;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
    for (const Problem& problem : tests) {
      Item item(robot, problem, study.settings.resolution);
      for (const Guide way : {Guide::None, Guide::Retreat})
        add_costs(robot, item, way == Guide::None ? compared.uniform : compared.retreat,
                  [&] { return queries.search(item, way, problem.seed + seed).waypoints; });
      add_costs(robot, item, compared.recalled, [&]() -> std::optional<Eigen::MatrixXd> {
        const double from_s = thread_cpu_s();
        auto summary = queries.recall(item, guide);
        compared.tries += summary.tries;
        compared.expected += summary.expected;
        if (summary.waypoints) {
          ++compared.hits;
          compared.hit_s += thread_cpu_s() - from_s;
          return std::move(summary.waypoints);
        }
        return queries.search(item, fallback, problem.seed + seed, std::move(summary.failed))
            .waypoints;
      });
    }
  print_as(name, *library, compared);
}

/// "3.12 (2.98) of 5.40 (5.01)": mean and median of a measure, of the queries that both solved.
std::string measure_text(const Costs& one, const Costs& other,
                         std::optional<double> ProblemResult::*measure, double scale) {
  std::vector<double> ones, others;
  for (std::size_t i = 0; i < one.paths.size(); ++i)
    if (one.paths[i].*measure && other.paths[i].*measure) {
      ones.push_back(scale * *(one.paths[i].*measure));
      others.push_back(scale * *(other.paths[i].*measure));
    }
  if (ones.empty())
    return "-";
  char text[80];
  std::snprintf(text, sizeof text, "%.2f (%.2f) of %.2f (%.2f)", mean(ones), median(ones),
                mean(others), median(others));
  return text;
}

void print_as(const std::string& name, const RecallLibrary& library, const Compared& compared) {
  const auto& [uniform, retreat, recalled, hits, tries, hit_s, expected, made_s] = compared;
  const auto ratio = [](const std::vector<double>& a, const std::vector<double>& b, double at) {
    return at < 0 ? mean(a) / mean(b) : percentile(a, at) / percentile(b, at);
  };
  const double count = static_cast<double>(recalled.checks.size());
  const auto measured = [&](std::optional<double> ProblemResult::*measure, double scale) {
    return measure_text(compared.recalled, compared.uniform, measure, scale);
  };
  char note[600];
  std::snprintf(
      note, sizeof note,
      "uniform / recalled: mean %.2f, median %.2f, 95 %% %.2f, checks %.2f; retreat %.2f; "
      "recalled %.0f %% (expected %.0f %%) in %.3f ms, %.1f tries; of uniform's, unshortened, "
      "mean (median): length %s, hand's %s m, least clearance %s mm; solved %d of %d; library of "
      "%zu paths for %zu queries, %zu modes, made in %.1f s",
      ratio(uniform.time_s, recalled.time_s, -1), ratio(uniform.time_s, recalled.time_s, 0.5),
      ratio(uniform.time_s, recalled.time_s, 0.95), ratio(uniform.checks, recalled.checks, -1),
      ratio(uniform.time_s, retreat.time_s, -1), 100.0 * hits / count, 100.0 * expected / count,
      1e3 * hit_s / std::max(hits, 1), static_cast<double>(tries) / count,
      measured(&ProblemResult::path_length, 1).c_str(),
      measured(&ProblemResult::hand_length_m, 1).c_str(),
      measured(&ProblemResult::least_clearance_m, 1e3).c_str(), recalled.solved, uniform.solved,
      library.paths.size(), library.queries.size(), library.modes.size(), made_s);
  print({.name = name,
         .value = 1e3 * mean(recalled.time_s),
         .unit = "ms",
         .reference = Reference{"uniform", 1e3 * mean(uniform.time_s)},
         .note = note});
}

/// How dear queries are by uniform planning.
void print_dearness(const Robot& robot, const experiments::Study& study, const std::string& name,
                    const std::vector<Problem>& tests) {
  Costs costs;
  std::size_t within_1_s = 0;
  const Queries queries(robot, study);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
    for (const Problem& problem : tests) {
      Item item(robot, problem, study.settings.resolution);
      const int solved = costs.solved;
      add_costs(robot, item, costs,
                [&] { return queries.search(item, Guide::None, problem.seed + seed).waypoints; });
      if (costs.solved > solved && costs.time_s.back() <= 1)
        ++within_1_s;
    }
  char note[200];
  std::snprintf(note, sizeof note,
                "median %.2f, 95 %% %.2f ms; checks: mean %.0f, median %.0f; solved %d, within 1 s "
                "%zu of %zu",
                1e3 * percentile(costs.time_s, 0.5), 1e3 * percentile(costs.time_s, 0.95),
                mean(costs.checks), percentile(costs.checks, 0.5), costs.solved, within_1_s,
                costs.checks.size());
  print({.name = name + " uniform", .value = 1e3 * mean(costs.time_s), .unit = "ms", .note = note});
}

std::string name_of(const experiments::StudyRobot& robot) {
  return std::filesystem::path(robot.model).filename();
}

/// The robots of a study.
class Fleet {
 public:
  explicit Fleet(const experiments::Study& study) : study_(study) {
    for (const experiments::StudyRobot& placed : study.robots) {
      const std::filesystem::path models = test::source_dir() + "/robots/models";
      models::LoadedRobot loaded = load_robot_of(models / placed.model);
      guided::PlannedRobot planned(loaded.chain, loaded.shapes);
      auto draw = study.make_instances(loaded, placed);
      robots_.push_back(
          std::make_unique<Robot>(Robot{std::move(loaded), std::move(planned), std::move(draw)}));
    }
  }

  /// Own experience, and that of the next robot, on a set of instances; or uniform planning
  /// alone.
  void compare_all(std::size_t robot, experiments::InstanceSet set, bool is_uniform) const {
    const std::string name = study_.name + " " + name_of(study_.robots[robot]);
    const auto tests = draw(robot, set);
    if (is_uniform) {
      print_dearness(*robots_[robot], study_, name, tests);
      return;
    }
    compare(*robots_[robot], study_, name + " own", draw(robot, experiments::InstanceSet::Learning),
            tests, true);
    const std::size_t other = (robot + 1) % robots_.size();
    std::vector<Problem> told = draw(other, experiments::InstanceSet::Learning);
    for (Problem& each : told)
      each = as_told(each, *robots_[other], tests.front());
    compare(*robots_[robot], study_, name + " first day", told, tests, false);
  }

 private:
  std::vector<Problem> draw(std::size_t robot, experiments::InstanceSet which) const {
    constexpr std::uint32_t kInstances = 50;
    std::vector<Problem> problems;
    for (std::uint32_t i = 0; i < kInstances; ++i)
      problems.push_back(robots_[robot]->draw(experiments::seed_of(which, robot), i));
    return problems;
  }

  /// A record of another robot as it is for one that stands and starts as in a problem of its
  /// own.
  static Problem as_told(const Problem& record, const Robot& recorder, Problem own) {
    own.scene = record.scene;
    own.seed = record.seed;
    const Eigen::Isometry3d T_task_base =
        record.T_task_base.value_or(Eigen::Isometry3d::Identity());
    own.T_task_start =
        T_task_base * kinematics::T_base_transfer(recorder.planned.chain, record.start);
    own.T_task_goal = record.T_task_goal;
    if (!own.T_task_goal)
      own.T_task_goal =
          T_task_base *
          kinematics::T_base_transfer(recorder.planned.chain, record.goal_configurations.col(0));
    own.goal_configurations.resize(0, 0);
    return own;
  }

  const experiments::Study& study_;
  std::vector<std::unique_ptr<Robot>> robots_;
};

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  using namespace kinship;
  std::vector<std::string> words(argv + 1, argv + argc);
  const bool is_uniform = std::erase(words, "--uniform") > 0;
  const auto take = [&](const std::string& name) {
    const auto at = std::ranges::find(words, name);
    if (at == words.end())
      return std::string();
    const std::string value = at[1];
    words.erase(at, at + 2);
    return value;
  };
  const std::string set = take("--set"), kind = take("--kind");
  std::vector<experiments::Study> studies;
  if (std::filesystem::is_directory(words.at(0)))
    studies = bench::studies_of(words.at(0));
  else
    for (const experiments::Study* study : experiments::find_studies(words.at(0)))
      studies.push_back(*study);
  for (const experiments::Study& study : studies) {
    if (!kind.empty() && study.name != kind)
      continue;
    const bench::Fleet fleet(study);
    for (std::size_t robot = 0; robot < study.robots.size(); ++robot)
      if (words.size() == 1 ||
          std::ranges::find(words.begin() + 1, words.end(), bench::name_of(study.robots[robot])) !=
              words.end())
        fleet.compare_all(robot, experiments::parse_instance_set(set.empty() ? "tuning" : set),
                          is_uniform);
  }
}
