#include "client/ompl/recall_planner.hpp"

#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "client/ompl/ompl_planners.hpp"
#include "client/ompl/state_space.hpp"

namespace kinship::ompl_planners {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

struct Ended {};  // leaves recall between two checks

Eigen::Index dof_of(const ob::SpaceInformation& information) {
  if (dynamic_cast<const ob::RealVectorStateSpace*>(information.getStateSpace().get()) == nullptr)
    throw std::invalid_argument("RecallPlanner: space '" + information.getStateSpace()->getName() +
                                "' is no RealVectorStateSpace");
  return static_cast<Eigen::Index>(information.getStateDimension());
}

Eigen::Matrix2Xd bounds_of(const ob::SpaceInformation& information) {
  const ob::RealVectorBounds& bounds =
      information.getStateSpace()->as<ob::RealVectorStateSpace>()->getBounds();
  const auto dof = static_cast<Eigen::Index>(bounds.low.size());
  Eigen::Matrix2Xd rows(2, dof);
  rows.row(0) = Eigen::Map<const Eigen::RowVectorXd>(bounds.low.data(), dof);
  rows.row(1) = Eigen::Map<const Eigen::RowVectorXd>(bounds.high.data(), dof);
  return rows;
}

double read_trust(double trust) {
  if (!(trust >= 0 && trust <= 1))
    throw std::invalid_argument("RecallPlanner: trust is " + std::to_string(trust) +
                                ", must be 0 to 1");
  return trust;
}

}  // namespace

RecallPlanner::RecallPlanner(const ob::SpaceInformationPtr& information,
                             std::shared_ptr<const recall::RecallGuide> guide,
                             ob::PlannerPtr otherwise)
    : ob::Planner(information, "Recall"),
      dof_(dof_of(*information)),
      otherwise_(otherwise ? std::move(otherwise)
                           : make_ompl_planner("RRTConnect", 0, information)) {
  set_guide(std::move(guide));
  specs_ = otherwise_->getSpecs();
  params_.declareParam<double>(
      "trust", [this](double trust) { trust_ = read_trust(trust); },
      [this] { return trust_.value_or(learned_trust_.value()); });
  addPlannerProgressProperty("recalled BOOLEAN", [this] { return std::string(path_ ? "1" : "0"); });
  addPlannerProgressProperty("recall tries INTEGER",
                             [this] { return std::to_string(recalled_.tries); });
}

void RecallPlanner::set_guide(std::shared_ptr<const recall::RecallGuide> guide) {
  if (guide && guide->warper().chain().dof() != dof_)
    throw std::invalid_argument("RecallPlanner: the space has " + std::to_string(dof_) +
                                " joints, the paths have " +
                                std::to_string(guide->warper().chain().dof()));
  guide_ = std::move(guide);
}

void RecallPlanner::set_scene(const Eigen::Isometry3d& T_task_base,
                              std::vector<SceneObject> objects) {
  T_task_base_ = T_task_base;
  objects_ = std::move(objects);
}

ob::PlannerStatus RecallPlanner::solve(const ob::PlannerTerminationCondition& ended) {
  checkValidity();
  forget();
  if (guide_ && pdef_->getGoal()->hasType(ob::GOAL_SAMPLEABLE_REGION))
    recall(ended);
  if (!path_)
    return otherwise_->solve(ended);
  pdef_->addSolutionPath(path_, false, 0, getName());
  return ob::PlannerStatus::EXACT_SOLUTION;
}

Eigen::MatrixXd RecallPlanner::next_goals(const ob::PlannerTerminationCondition& ended) {
  constexpr int kMostAttempts = 32;
  Eigen::MatrixXd goals(dof_, kMostAttempts);
  Eigen::Index count = 0;
  // Of states that do not change OMPL would wait for a valid one until the end.
  bool waits = pdef_->getGoal()->hasType(ob::GOAL_LAZY_SAMPLES);
  for (int attempts = 0; attempts < kMostAttempts && !ended && (waits || pis_.haveMoreGoalStates());
       ++attempts)
    if (const ob::State* goal =
            std::exchange(waits, false) ? pis_.nextGoal(ended) : pis_.nextGoal())
      goals.col(count++) = to_configuration(*goal, dof_);
  return goals.leftCols(count);
}

planning::IsFree RecallPlanner::what_is_free(const ob::PlannerTerminationCondition& ended) const {
  struct Pair {
    explicit Pair(const ob::SpaceInformationPtr& information)
        : from(information), to(information) {}
    ob::ScopedState<> from, to;
  };
  const auto states = std::make_shared<Pair>(si_);
  return {[this, states, &ended](const Eigen::VectorXd& q) {
            if (ended)
              throw Ended();
            copy_to_state(q, *states->to.get());
            return si_->isValid(states->to.get());
          },
          {},
          {},
          [this, states, &ended](const auto& from, const auto& to) {
            planning::IsFree::Lines lines(static_cast<std::size_t>(from.cols()));
            for (Eigen::Index i = 0; i < from.cols(); ++i) {
              if (ended)
                throw Ended();
              copy_to_state(from.col(i), *states->from.get());
              copy_to_state(to.col(i), *states->to.get());
              if (!si_->checkMotion(states->from.get(), states->to.get()))
                break;
              lines[static_cast<std::size_t>(i)] = true;
            }
            return lines;
          }};
}

void RecallPlanner::recall(const ob::PlannerTerminationCondition& ended) {
  if (!pis_.haveMoreStartStates())
    return;
  recall::Query query;
  query.T_task_base = T_task_base_;
  query.bounds = bounds_of(*si_);
  query.goals = next_goals(ended);
  query.T_task_anchors = recall::find_anchors(guide_->library().anchors, objects_);
  recall::RecallOptions options{.step = si_->getStateSpace()->getLongestValidSegmentLength()};
  const planning::IsFree is_free = what_is_free(ended);
  try {
    while (const ob::State* start = query.goals.cols() == 0 || path_ ? nullptr : pis_.nextStart()) {
      query.start = to_configuration(*start, dof_);
      options.trust = trust_.value_or(learned_trust_.value());
      recalled_ = recall::recall(*guide_, query, is_free, options);
      learned_trust_.add(recalled_.expected,
                         recalled_.waypoints.has_value() && !recalled_.is_straight_line);
      if (!recalled_.waypoints)
        continue;
      path_ = std::make_shared<og::PathGeometric>(si_);
      ob::ScopedState<> state(si_);
      for (const auto& q : recalled_.waypoints->colwise()) {
        copy_to_state(q, *state.get());
        path_->append(state.get());
      }
    }
  } catch (const Ended&) {  // the other planner says so
  }
}

void RecallPlanner::setProblemDefinition(const ob::ProblemDefinitionPtr& problem) {
  ob::Planner::setProblemDefinition(problem);
  otherwise_->setProblemDefinition(problem);
}

void RecallPlanner::setup() {
  ob::Planner::setup();
  if (!otherwise_->isSetup())
    otherwise_->setup();
}

void RecallPlanner::clear() {
  ob::Planner::clear();
  otherwise_->clear();
  forget();
}

void RecallPlanner::clearQuery() {
  pis_.restart();
  otherwise_->clearQuery();
  forget();
}

void RecallPlanner::forget() {
  recalled_ = {};
  path_.reset();
}

void RecallPlanner::getPlannerData(ob::PlannerData& data) const {
  ob::Planner::getPlannerData(data);
  if (!path_) {
    otherwise_->getPlannerData(data);
    return;
  }
  const std::vector<ob::State*>& states = path_->getStates();
  data.addStartVertex(ob::PlannerDataVertex(states.front()));
  data.addGoalVertex(ob::PlannerDataVertex(states.back()));
  for (std::size_t i = 1; i < states.size(); ++i)
    data.addEdge(ob::PlannerDataVertex(states[i - 1]), ob::PlannerDataVertex(states[i]));
}

}  // namespace kinship::ompl_planners
