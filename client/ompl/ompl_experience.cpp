#include "client/ompl/ompl_experience.hpp"

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/planners/experience/LightningRetrieveRepair.h>
#include <ompl/tools/lightning/LightningDB.h>
#include <ompl/tools/thunder/Thunder.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "client/ompl/guided_state_sampler.hpp"
#include "client/ompl/ompl_planners.hpp"
#include "client/ompl/state_space.hpp"
#include "proto/types/failure.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_budget.hpp"

namespace kinship::ompl_planners {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
namespace ot = ompl::tools;

/// OMPL's, but the goal that experience fits best, and without the shortening at the end.
class LightningRecall : public og::LightningRetrieveRepair {
 public:
  using og::LightningRetrieveRepair::LightningRetrieveRepair;

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& ended) override {
    const ob::State* const start = pis_.nextStart();
    const ob::State* goal = nullptr;
    double nearest = std::numeric_limits<double>::infinity();
    while (const ob::State* next = start == nullptr ? nullptr : pis_.nextGoal()) {
      const auto paths = experienceDB_->findNearestStartGoal(nearestK_, start, next);
      if (paths.empty() || distance(*paths.front(), start, next) >= nearest)
        continue;
      nearest = distance(*paths.front(), start, next);
      nearestPaths_ = paths;
      goal = next;
    }
    ob::PlannerDataPtr chosen;
    if (goal == nullptr || !findBestPath(start, goal, chosen))
      return ob::PlannerStatus::ABORT;
    const auto path = std::make_shared<og::PathGeometric>(si_);
    path->append(start);
    for (unsigned int i = 0; i < chosen->numVertices(); ++i)
      path->append(chosen->getVertex(i).getState());
    path->append(goal);
    if (!repairPath(ended, *path))
      return ob::PlannerStatus::ABORT;
    pdef_->addSolutionPath(path, false, 0, getName());
    return ob::PlannerStatus::EXACT_SOLUTION;
  }

 private:
  /// From the ends of a path, the better way round, to the ends of a query.
  double distance(const ob::PlannerData& path, const ob::State* start,
                  const ob::State* goal) const {
    const ob::State* const first = path.getVertex(0).getState();
    const ob::State* const last = path.getVertex(path.numVertices() - 1).getState();
    return std::min(si_->distance(start, first) + si_->distance(goal, last),
                    si_->distance(start, last) + si_->distance(goal, first));
  }
};

/// Either database, as this file uses it.
class Memory {
 public:
  virtual ~Memory() = default;
  virtual bool learn(og::PathGeometric& path) = 0;
  virtual std::size_t size() const = 0;
  virtual const ob::PlannerPtr& planner() const = 0;
  /// Whether the planner chooses among several goals itself.
  virtual bool knows_goals() const = 0;
};

class LightningMemory : public Memory {
 public:
  LightningMemory(const ob::SpaceInformationPtr& information, double range)
      : paths_(std::make_shared<ot::LightningDB>(information->getStateSpace())) {
    const auto planner = std::make_shared<LightningRecall>(information, paths_);
    planner->setRepairPlanner(make_ompl_planner("RRTConnect", range, information));
    planner_ = planner;
  }

  bool learn(og::PathGeometric& path) override {
    const std::size_t before = paths_->getExperiencesCount();
    double time_s = 0;
    paths_->addPath(path, time_s);
    return paths_->getExperiencesCount() == before + 1;
  }
  std::size_t size() const override { return paths_->getExperiencesCount(); }
  const ob::PlannerPtr& planner() const override { return planner_; }
  bool knows_goals() const override { return true; }

 private:
  ot::LightningDBPtr paths_;
  ob::PlannerPtr planner_;
};

/// The framework itself sets its roadmap up; of its threads nothing is used.
class ThunderMemory : public Memory, private ot::Thunder {
 public:
  ThunderMemory(const ob::SpaceInformationPtr& information, double range)
      : ot::Thunder(information) {
    setRepairPlanner(make_ompl_planner("RRTConnect", range, information));
  }

  bool learn(og::PathGeometric& path) override {
    if (!is_set_up_) {  // the roadmap wants a problem, any problem
      const auto last = static_cast<unsigned int>(path.getStateCount() - 1);
      setStartAndGoalStates({space(), path.getState(0)}, {space(), path.getState(last)});
      setup();
      is_set_up_ = true;
    }
    double time_s = 0;
    return experienceDB_->addPath(path, time_s);
  }
  std::size_t size() const override {
    return is_set_up_ ? experienceDB_->getSPARSdb()->getNumVertices() : 0;
  }
  const ob::PlannerPtr& planner() const override { return rrPlanner_; }
  bool knows_goals() const override { return false; }

 private:
  const ob::StateSpacePtr& space() const { return getStateSpace(); }

  bool is_set_up_ = false;
};

std::unique_ptr<Memory> make_memory(ExperienceKind kind, const ob::SpaceInformationPtr& information,
                                    double range) {
  if (kind == ExperienceKind::Lightning)
    return std::make_unique<LightningMemory>(information, range);
  return std::make_unique<ThunderMemory>(information, range);
}

}  // namespace

class OmplExperience::Implementation {
 public:
  Implementation(ExperienceKind kind, const Eigen::Matrix2Xd& bounds, double step, double range)
      : bounds_(bounds), space_(make_state_space(bounds)) {
    if (!(step > 0))
      throw std::invalid_argument("OmplExperience: step " + std::to_string(step) +
                                  " is not positive");
    ompl::msg::noOutputHandler();
    // A little shorter, so that a distance of whole steps is cut alike here and there.
    part_ = step * (1 - 1e-9);
    information_ = std::make_shared<ob::SpaceInformation>(space_);
    information_->setStateValidityCheckingResolution(part_ / space_->getMaximumExtent());
    information_->setStateValidityChecker([this](const ob::State* state) {
      return budget_ != nullptr && budget_->is_free(to_configuration(*state, bounds_.cols()));
    });
    information_->setup();
    memory_ = make_memory(kind, information_, range);
  }

  bool learn(const Eigen::MatrixXd& waypoints, const planning::IsFree& is_free) {
    planning::PlanningBudget budget(is_free, std::numeric_limits<std::uint64_t>::max(),
                                    std::chrono::hours(1));
    budget_ = &budget;
    og::PathGeometric path(information_);
    ob::ScopedState<> state(information_);
    for (const auto& q : waypoints.colwise()) {
      copy_to_state(q, *state.get());
      path.append(state.get());
    }
    const bool kept = memory_->learn(path);
    budget_ = nullptr;
    learning_checks_ += budget.checks();
    return kept;
  }

  planning::PlanSummary recall(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                               const planning::IsFree& is_free,
                               const planning::BirrtOptions& limits, std::mt19937_64& generator) {
    planning::PlanningBudget budget(is_free, limits.max_checks, limits.time_limit);
    budget_ = &budget;
    install_guided_sampler(*space_, std::make_shared<planning::ConfigurationSampler>(bounds_),
                           generator());
    planning::PlanSummary summary;
    if (memory_->size() > 0 && budget.is_free(start)) {
      // OMPL stops looking at the first goal that collides; Thunder then does not come back.
      const Eigen::MatrixXd targets = free_ones(goals, budget);
      const Eigen::Index at_once =
          memory_->knows_goals() ? std::max(targets.cols(), Eigen::Index{1}) : 1;
      for (Eigen::Index i = 0; i < targets.cols() && !summary.waypoints; i += at_once)
        summary.waypoints = solve(start, targets.middleCols(i, at_once));
    }
    summary.collision_checks = budget.checks();
    summary.planning_time_s = budget.thread_time_s();
    if (!summary.waypoints)
      summary.reason = budget.exhausted() ? budget.reason() : planning::NoPath::NothingRecalled;
    else if (!is_path(*summary.waypoints, is_free)) {
      summary.waypoints.reset();
      summary.reason = planning::NoPath::RecallCollides;
    }
    budget_ = nullptr;
    return summary;
  }

  const Memory& memory() const { return *memory_; }
  std::uint64_t learning_checks() const { return learning_checks_; }

 private:
  std::optional<Eigen::MatrixXd> solve(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    const auto problem = std::make_shared<ob::ProblemDefinition>(information_);
    const auto targets = std::make_shared<ob::GoalStates>(information_);
    ob::ScopedState<> state(information_);
    for (const auto& goal : goals.colwise()) {
      copy_to_state(goal, *state.get());
      targets->addState(state);
    }
    copy_to_state(start, *state.get());
    problem->addStartState(state);
    problem->setGoal(targets);
    const ob::PlannerPtr& planner = memory_->planner();
    planner->clear();
    planner->setProblemDefinition(problem);
    planner->setup();
    const ob::PlannerTerminationCondition ended([this] { return budget_->exhausted(); });
    if (planner->solve(ended) != ob::PlannerStatus::EXACT_SOLUTION || !problem->hasExactSolution())
      return std::nullopt;
    auto& path = *problem->getSolutionPath()->as<og::PathGeometric>();
    return planning::densified(to_waypoints(path.getStates(), bounds_.cols()), part_);
  }

  static Eigen::MatrixXd free_ones(const Eigen::MatrixXd& goals, planning::PlanningBudget& budget) {
    Eigen::MatrixXd kept(goals.rows(), goals.cols());
    Eigen::Index count = 0;
    for (const auto& goal : goals.colwise())
      if (budget.is_free(goal))
        kept.col(count++) = goal;
    return kept.leftCols(count);
  }

  static bool is_path(const Eigen::MatrixXd& waypoints, const planning::IsFree& is_free) {
    return std::ranges::all_of(waypoints.colwise(), [&](const auto& q) { return is_free(q); });
  }

  const Eigen::Matrix2Xd bounds_;
  std::shared_ptr<ob::RealVectorStateSpace> space_;
  double part_ = 0;
  ob::SpaceInformationPtr information_;
  std::unique_ptr<Memory> memory_;
  planning::PlanningBudget* budget_ = nullptr;  // of the call under way
  std::uint64_t learning_checks_ = 0;
};

OmplExperience::OmplExperience(ExperienceKind kind, const Eigen::Matrix2Xd& bounds, double step,
                               double range)
    : implementation_(std::make_unique<Implementation>(kind, bounds, step, range)) {}
OmplExperience::~OmplExperience() = default;

bool OmplExperience::learn(const Eigen::MatrixXd& waypoints, const planning::IsFree& is_free) {
  try {
    return implementation_->learn(waypoints, is_free);
  } catch (const ompl::Exception& exception) {
    throw Failure(ErrorCode::Internal, std::string("OMPL: ") + exception.what());
  }
}

std::size_t OmplExperience::size() const { return implementation_->memory().size(); }

std::uint64_t OmplExperience::learning_checks() const { return implementation_->learning_checks(); }

planning::PlanSummary OmplExperience::recall(const Eigen::VectorXd& start,
                                             const Eigen::MatrixXd& goals,
                                             const planning::IsFree& is_free,
                                             const planning::BirrtOptions& limits,
                                             std::mt19937_64& generator) {
  try {
    return implementation_->recall(start, goals, is_free, limits, generator);
  } catch (const ompl::Exception& exception) {
    throw Failure(ErrorCode::Internal, std::string("OMPL: ") + exception.what());
  }
}

}  // namespace kinship::ompl_planners
