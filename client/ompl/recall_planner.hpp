#pragma once

#include <ompl/base/Planner.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "proto/types/scene.hpp"
#include "robots/recall/recall.hpp"
#include "robots/recall/recall_guide.hpp"
#include "robots/recall/recall_trust.hpp"

namespace ompl::geometric {
class PathGeometric;
}  // namespace ompl::geometric

namespace kinship::ompl_planners {

/// A planner of OMPL that first tries whole stored paths of the robot, moved onto the query, and
/// hands over to another planner where none is free; in the place of OMPL's Lightning and Thunder,
/// e.g. SimpleSetup::setPlanner. The problem's checkers decide what is free: each waypoint by the
/// StateValidityChecker, each line between two by the MotionValidator.
///
/// A solution says by its planner's name which of the two gave it: "Recall", or the name of the
/// other planner, which adds its own. recalled() tells more; so do the progress properties
/// "recalled BOOLEAN" and "recall tries INTEGER", e.g. to ompl::tools::Benchmark. The parameter
/// "trust" is the factor of every path's chance; it follows what the tries of this planner solved,
/// until it is set.
///
/// A path is not projected onto a constraint, though it may come from a query with one: only the
/// problem's checkers can refuse what leaves the constraint.
///
/// Not shared between threads.
class RecallPlanner : public ompl::base::Planner {
 public:
  /// \param information  its space is a RealVectorStateSpace, e.g. from make_state_space, with one
  ///                     number per joint of the guide's chain, joint units.
  /// \param guide        may be shared; null: nothing to recall.
  /// \param otherwise    plans where nothing is recalled, in the time that is left; null:
  ///                     RRTConnect.
  /// \throws std::invalid_argument for another space or another number of joints.
  RecallPlanner(const ompl::base::SpaceInformationPtr& information,
                std::shared_ptr<const recall::RecallGuide> guide,
                ompl::base::PlannerPtr otherwise = nullptr);

  /// Newer paths, from the next query on. \throws std::invalid_argument as the constructor.
  void set_guide(std::shared_ptr<const recall::RecallGuide> guide);

  /// Where the robot stands, and among what, from the next query on. Before: at the task frame,
  /// among nothing known.
  /// \param objects  of the scene, in the task frame: where those are that are named as in the
  ///                 recorded scenes, paths are moved with them. Not checked for collisions.
  void set_scene(const Eigen::Isometry3d& T_task_base, std::vector<SceneObject> objects);

  const ompl::base::PlannerPtr& otherwise() const { return otherwise_; }

  /// Of the last solve(): the path if it was recalled, tries, checks by the StateValidityChecker
  /// but those within motions.
  const recall::RecallSummary& recalled() const { return recalled_; }

  /// Tries paths for each start and goal that OMPL knows by now (of lazily sampled goals it waits
  /// for one), at most 32 goals; then the other planner's solve(). Without a valid start or goal
  /// the other planner answers at once; so it does when asked to go on without a new start.
  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& ended) override;

  void setProblemDefinition(const ompl::base::ProblemDefinitionPtr& problem) override;
  void setup() override;
  void clear() override;
  void clearQuery() override;
  void getPlannerData(ompl::base::PlannerData& data) const override;

 private:
  Eigen::MatrixXd next_goals(const ompl::base::PlannerTerminationCondition& ended);
  planning::IsFree what_is_free(const ompl::base::PlannerTerminationCondition& ended) const;
  void recall(const ompl::base::PlannerTerminationCondition& ended);
  void forget();

  const Eigen::Index dof_;
  std::shared_ptr<const recall::RecallGuide> guide_;
  const ompl::base::PlannerPtr otherwise_;
  Eigen::Isometry3d T_task_base_ = Eigen::Isometry3d::Identity();
  std::vector<SceneObject> objects_;
  recall::RecallTrust learned_trust_;
  std::optional<double> trust_;  // set by the user
  recall::RecallSummary recalled_;
  std::shared_ptr<ompl::geometric::PathGeometric> path_;  // of recalled_; shared with the problem
};

}  // namespace kinship::ompl_planners
