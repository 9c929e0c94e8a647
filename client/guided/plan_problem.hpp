#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/guided/plan_settings.hpp"
#include "client/guided/query_sampler.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/problem.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/collision/robot_solids.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/tree.hpp"

namespace kinship::guided {

/// The robot as planning uses it.
struct PlannedRobot {
  /// \throws Failure(InvalidInput) as collision::RobotSolids.
  PlannedRobot(kinematics::Chain its_chain, const geometry::RobotShapes& shapes)
      : chain(std::move(its_chain)), solids(chain, shapes), solver(chain) {}

  kinematics::Chain chain;
  collision::RobotSolids solids;  ///< shared by the worlds of all problems
  inverse::Solver solver;
};

struct PlannedProblem {
  ProblemResult result;
  std::string planner;  ///< its name alone; further remarks are in the result
  Outcome outcome = Outcome::Failed;
  std::vector<std::string> moved;  ///< sentences on starts and goals moved onto a limit
  double recall_expected = 0;      ///< chance that the recalled paths tried would do, 0 to 1
  bool attempted = false;    ///< false if the problem does not fit the robot: nothing was planned
  bool interrupted = false;  ///< `stop` ended it; the other members are then meaningless
  std::optional<SearchRecord> search = {};  ///< as PlanSettings::record_search says
  /// Bodies within a closed mesh at the start, which no check notices.
  std::vector<collision::CollisionWorld::Enclosed> enclosed = {};
};

/// Plans one problem: goal configurations by inverse kinematics (all that are free, up to
/// settings.max_goals), the planner of the settings, light shortcutting. For a problem that does
/// not fit the robot or the planner, or cannot be solved, the result has the reason. Equal problem,
/// guidance and settings give an equal path and equal checks, as long as the time limit does not
/// end it.
/// \param query  one that is not guided is planned exactly as if there were no guidance. The result
///               of a guided one names the source of its samples (make_query_sampler). Guidance of
///               another placement than the problem's is a mismatch, whose reason names both.
/// \param stop   called before every check; true ends planning.
/// \param recorder  records how the trees grow, except those of other libraries; null: no
///                  recording.
PlannedProblem plan_problem(const PlannedRobot& robot, const Problem& problem,
                            const QueryGuidance& query, const PlanSettings& settings,
                            const std::function<bool()>& stop,
                            planning::SearchRecorder* recorder = nullptr);

}  // namespace kinship::guided
