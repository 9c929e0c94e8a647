#include "client/ompl/ompl_planners.hpp"

#include <ompl/geometric/planners/prm/LazyPRM.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/LazyRRT.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/rrt/TRRT.h>

#include <functional>
#include <map>
#include <memory>
#include <stdexcept>

#include "client/ompl/ompl_planner.hpp"

namespace kinship::ompl_planners {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

/// OMPL's roadmap, grown and searched in turn by one thread. OMPL's own solve searches, and adds
/// goals with their collision questions, in a second thread, and grows by the clock.
class SerialPrm : public og::PRM {
 public:
  SerialPrm(const ob::SpaceInformationPtr& information, bool star) : og::PRM(information, star) {}

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& ended) override {
    checkValidity();
    add_start_and_goals();
    if (startM_.empty())
      return ob::PlannerStatus::INVALID_START;
    if (goalM_.empty())
      return ob::PlannerStatus::INVALID_GOAL;
    ob::PathPtr path;
    while (!maybeConstructSolution(startM_, goalM_, path)) {
      if (ended)
        return ob::PlannerStatus::TIMEOUT;
      const unsigned long target = milestoneCount() + kMilestonesPerSearch;
      growRoadmap(
          ob::PlannerTerminationCondition([&] { return ended() || milestoneCount() >= target; }));
    }
    pdef_->addSolutionPath(path);
    return ob::PlannerStatus::EXACT_SOLUTION;
  }

 private:
  static constexpr unsigned long kMilestonesPerSearch = 10;

  void add_start_and_goals() {
    while (const ob::State* start = pis_.nextStart())
      startM_.push_back(addMilestone(si_->cloneState(start)));
    while (const ob::State* goal = pis_.nextGoal())
      goalM_.push_back(addMilestone(si_->cloneState(goal)));
  }
};

/// OMPL's, but all goals are roots from the beginning. OMPL adds the second goal when the goal
/// tree has grown, which it never does from a goal that is walled in.
class ManyGoalsRrtConnect : public og::RRTConnect {
 public:
  using og::RRTConnect::RRTConnect;

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& ended) override {
    checkValidity();
    while (const ob::State* goal = pis_.nextGoal()) {
      auto* root = new Motion(si_);  // the tree's, which deletes it
      si_->copyState(root->state, goal);
      root->root = root->state;
      tGoal_->add(root);
    }
    return og::RRTConnect::solve(ended);
  }
};

/// OMPL's, but all goals are milestones from the beginning. OMPL looks at the first only.
class ManyGoalsLazyPrm : public og::LazyPRM {
 public:
  using og::LazyPRM::LazyPRM;

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& ended) override {
    checkValidity();
    while (const ob::State* goal = pis_.nextGoal())
      goalM_.push_back(addMilestone(si_->cloneState(goal)));
    return og::LazyPRM::solve(ended);
  }
};

using Allocator = std::function<ob::PlannerPtr(const ob::SpaceInformationPtr&)>;

template <typename Planner>
Allocator allocator() {
  return [](const ob::SpaceInformationPtr& information) {
    return std::make_shared<Planner>(information);
  };
}

template <typename Roadmap>
Allocator roadmap_allocator(bool star) {
  return [star](const ob::SpaceInformationPtr& information) {
    return std::make_shared<Roadmap>(information, star);
  };
}

const std::map<std::string, Allocator>& allocators() {
  static const std::map<std::string, Allocator> all = {
      {"LazyPRM", roadmap_allocator<ManyGoalsLazyPrm>(false)},
      {"LazyPRMstar", roadmap_allocator<ManyGoalsLazyPrm>(true)},
      {"LazyRRT", allocator<og::LazyRRT>()},
      {"PRM", roadmap_allocator<SerialPrm>(false)},
      {"PRMstar", roadmap_allocator<SerialPrm>(true)},
      {"RRT", allocator<og::RRT>()},
      {"RRTConnect", allocator<ManyGoalsRrtConnect>()},
      {"RRTstar", allocator<og::RRTstar>()},
      {"TRRT", allocator<og::TRRT>()}};
  return all;
}

}  // namespace

std::vector<std::string> ompl_planner_names() {
  std::vector<std::string> names;
  for (const auto& [name, allocate] : allocators())
    names.push_back(name);
  return names;
}

ob::PlannerPtr make_ompl_planner(const std::string& name, double range,
                                 const ob::SpaceInformationPtr& information) {
  const auto found = allocators().find(name);
  if (found == allocators().end()) {
    std::string message = "OMPL planner '" + name + "' is unknown, there are";
    for (const std::string& known : ompl_planner_names())
      message += " " + known;
    throw std::invalid_argument(message);
  }
  if (!(range >= 0))
    throw std::invalid_argument("OMPL planner '" + name + "': range " + std::to_string(range) +
                                " is negative");
  ob::PlannerPtr planner = found->second(information);
  if (range > 0 && planner->params().hasParam("range"))
    planner->params().setParam("range", std::to_string(range));
  return planner;
}

}  // namespace kinship::ompl_planners
