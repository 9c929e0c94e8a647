#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>

#include "client/plan/plan_settings.hpp"
#include "client/planning/arm_choice.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/problem.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::plan {

/// What planning knows about the robot.
struct PlannedRobot {
  kinematics::Chain chain;
  geometry::RobotShapes shapes;
};

/// A distribution to draw samples from.
struct Guidance {
  Digest distribution_id;
  std::uint64_t revision = 0;
  Mixture mixture;
  planning::ArmPlan arms;  ///< which queries use it, and with what share of samples
};

struct PlannedProblem {
  ProblemResult result;
  Outcome outcome = Outcome::Failed;
  bool attempted = false;    ///< false if the problem does not fit the robot: nothing was planned
  bool interrupted = false;  ///< given up because `stop` said so; the rest is then not meaningful
};

/// Plans one problem: goal configurations by inverse kinematics (all that are free, up to
/// settings.max_goals), BiRRT, or CBiRRT2 under a constraint, light shortcutting. A problem that
/// does not fit the robot, or cannot be solved, is answered with its reason. Equal problem,
/// guidance and settings give an equal path and equal checks, as long as the time limit does not
/// end it. \param guidance  null: uniform. Otherwise the problem's arm is chosen by its plan: a
/// query of the
///                  control arm is planned exactly as if there were no guidance.
/// \param stop      asked before every check; true gives up.
PlannedProblem plan_problem(const PlannedRobot& robot, const Problem& problem,
                            const Guidance* guidance, const PlanSettings& settings,
                            const std::function<bool()>& stop);

}  // namespace kinship::plan
