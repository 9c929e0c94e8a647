// RecallPlanner beside OMPL's Lightning and RRTConnect alone, as users of OMPL have them: in a
// SimpleSetup, with the same checker, the same recorded queries and the same fresh ones. Lightning
// learns the paths that answered the recorded queries, the library is made of them. It plans from
// scratch in a second thread, so that its processor time is that of both.
//
//   recall_planner_bench [RECORDED] [FRESH]

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/tools/lightning/Lightning.h>
#include <ompl/tools/lightning/LightningDB.h>
#include <ompl/util/Console.h>

#include <array>
#include <atomic>
#include <mutex>

#include "client/ompl/recall_planner.hpp"
#include "client/ompl/state_space.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
namespace ot = ompl::tools;
using recall::PosedQuery;
using Cell = recall::test_support::ShelfCell;  // its robot, and queries into a shelf

constexpr double kStep = recall::test_support::kStep;
constexpr double kLimit_s = 10;

/// Queries that carry a box from a table into a shelf among posts: the start differs, too.
std::vector<PosedQuery> carrying(const Cell& cell, std::uint64_t first, std::uint64_t count) {
  std::vector<PosedQuery> queries;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    std::mt19937_64 generator(seed);
    const ShelfCell drawn = make_shelf_cell(cell.chain, generator);
    collision::CollisionWorld world(cell.solids, drawn.surroundings);
    const Eigen::MatrixXd starts =
        free_configurations(cell.chain, world, drawn.T_base_start, cell.start);
    if (starts.cols() == 0)
      continue;
    PosedQuery posed{
        recall::test_support::report_of(seed), {}, drawn.surroundings, {}, starts.col(0), {}};
    posed.bounds = planning::planning_bounds(cell.chain, posed.start);
    posed.goals = free_configurations(cell.chain, world, drawn.T_base_goal, posed.start);
    if (posed.goals.cols() > 0)
      queries.push_back(std::move(posed));
  }
  return queries;
}

/// A checker for the two threads of Lightning: a world for each.
class Checker {
 public:
  Checker(const Cell& cell, const PosedQuery& posed)
      : worlds_{{{cell.solids, posed.surroundings}, {cell.solids, posed.surroundings}}} {}

  bool is_free(const Eigen::VectorXd& q) {
    ++checks;
    std::unique_lock lock(mutexes_[0], std::try_to_lock);
    if (lock.owns_lock())
      return !worlds_[0].collides(q);
    const std::scoped_lock other(mutexes_[1]);
    return !worlds_[1].collides(q);
  }

  std::atomic<std::uint64_t> checks = 0;

 private:
  std::array<std::mutex, 2> mutexes_;
  std::array<collision::CollisionWorld, 2> worlds_;
};

/// Lightning, with a way to teach it.
class Lightning : public ot::Lightning {
 public:
  using ot::Lightning::Lightning;
  void learn(og::PathGeometric path) {
    double time_s = 0;
    experienceDB_->addPath(path, time_s);
  }
};

struct Costs {
  std::vector<double> checks, wall_ms, cpu_ms, lengths;
  int solved = 0;
};

/// One way to plan, for query after query in one space.
class Way {
 public:
  Way(const Cell& cell, og::SimpleSetup& setup) : cell_(cell), setup_(setup) {
    const auto& space = setup.getStateSpace();
    setup.getSpaceInformation()->setStateValidityCheckingResolution(kStep /
                                                                    space->getMaximumExtent());
    setup.setStateValidityChecker([this](const ob::State* state) {
      return checker_->is_free(ompl_planners::to_configuration(*state, cell_.chain.dof()));
    });
  }

  std::optional<Eigen::MatrixXd> solve(const PosedQuery& posed) {
    checker_ = std::make_unique<Checker>(cell_, posed);
    setup_.clear();
    setup_.clearStartStates();
    ob::ScopedState<> state(setup_.getStateSpace());
    ompl_planners::copy_to_state(posed.start, *state.get());
    setup_.addStartState(state);
    const auto goals = std::make_shared<ob::GoalStates>(setup_.getSpaceInformation());
    for (const auto& q : posed.goals.colwise()) {
      ompl_planners::copy_to_state(q, *state.get());
      goals->addState(state);
    }
    setup_.setGoal(goals);
    const double wall = wall_s(), cpu = process_cpu_s();
    const bool is_solved = setup_.solve(kLimit_s) == ob::PlannerStatus::EXACT_SOLUTION;
    costs.wall_ms.push_back(1e3 * (wall_s() - wall));
    costs.cpu_ms.push_back(1e3 * (process_cpu_s() - cpu));
    costs.checks.push_back(static_cast<double>(checker_->checks));
    if (!is_solved)
      return std::nullopt;
    ++costs.solved;
    costs.lengths.push_back(setup_.getSolutionPath().length());
    return ompl_planners::to_waypoints(setup_.getSolutionPath().getStates(), cell_.chain.dof());
  }

  Costs costs;

 private:
  const Cell& cell_;
  og::SimpleSetup& setup_;
  std::unique_ptr<Checker> checker_;
};

void print_as(const std::string& name, const Costs& costs, const Costs& reference,
              const std::string& note) {
  char text[300];
  std::snprintf(text, sizeof text,
                "processor: median %.2f, 95 %% %.2f ms; wall: mean %.2f, median %.2f ms; checks: "
                "mean %.0f; length %.2f; solved %d of %zu%s",
                median(costs.cpu_ms), percentile(costs.cpu_ms, 0.95), mean(costs.wall_ms),
                median(costs.wall_ms), mean(costs.checks), mean(costs.lengths), costs.solved,
                costs.checks.size(), note.c_str());
  print({.name = name,
         .value = mean(costs.cpu_ms),
         .unit = "ms",
         .reference = Reference{"RRTConnect", mean(reference.cpu_ms)},
         .note = text});
}

void compare(const std::string& name, const Cell& cell, std::vector<PosedQuery> recorded,
             const std::vector<PosedQuery>& fresh) {
  // Of all queries; their joints turn less than once.
  const ob::StateSpacePtr space = ompl_planners::make_state_space(recorded.front().bounds);
  og::SimpleSetup uniform_setup(space), recall_setup(space);
  Lightning lightning(space);
  Way uniform(cell, uniform_setup), by_lightning(cell, lightning), by_recall(cell, recall_setup);
  const auto rrt_connect = [](const ob::SpaceInformationPtr& information) {
    return std::make_shared<og::RRTConnect>(information);
  };
  uniform_setup.setPlannerAllocator(rrt_connect);
  lightning.setPlannerAllocator(rrt_connect);
  lightning.setRepairPlanner(rrt_connect(lightning.getSpaceInformation()));
  for (PosedQuery& posed : recorded)
    if ((posed.solution = uniform.solve(posed)))
      lightning.learn(uniform_setup.getSolutionPath());
  uniform.costs = {};
  const double begin_s = process_cpu_s();
  const auto library = cell.make(recorded);
  if (!library)
    throw std::runtime_error(name + ": no library");
  const double made_s = process_cpu_s() - begin_s;
  const auto planner = std::make_shared<ompl_planners::RecallPlanner>(
      recall_setup.getSpaceInformation(),
      std::make_shared<const recall::RecallGuide>(cell.chain, *library));
  recall_setup.setPlanner(planner);
  int recalled = 0;
  for (const PosedQuery& posed : fresh) {
    uniform.solve(posed);
    by_lightning.solve(posed);
    planner->set_scene(posed.surroundings.T_task_base, posed.surroundings.scene.objects);
    by_recall.solve(posed);
    recalled += planner->recalled().waypoints ? 1 : 0;
  }
  print_as(name + " RRTConnect", uniform.costs, uniform.costs, "");
  print_as(name + " Lightning", by_lightning.costs, uniform.costs,
           "; " + std::to_string(lightning.getExperiencesCount()) + " paths learned");
  print_as(name + " RecallPlanner", by_recall.costs, uniform.costs,
           "; recalled " + std::to_string(recalled) + "; library made in " +
               std::to_string(made_s) + " s");
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  using namespace kinship::bench;
  ompl::msg::noOutputHandler();
  const std::uint64_t recorded = argc > 1 ? std::stoul(argv[1]) : 40;
  const std::uint64_t fresh = argc > 2 ? std::stoul(argv[2]) : 100;
  const Cell cell;
  compare("shelf", cell, cell.queries(0, recorded), cell.queries(1000, fresh));
  compare("carry", cell, carrying(cell, 0, recorded), carrying(cell, 1000, fresh));
}
