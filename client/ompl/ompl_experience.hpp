#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>

#include "robots/planning/birrt.hpp"
#include "robots/planning/is_free.hpp"

namespace kinship::ompl_planners {

/// The planners of OMPL that reuse the robot's own paths.
enum class ExperienceKind {
  Lightning,  ///< whole paths: repairs the best match
  Thunder     ///< a sparse roadmap of the paths (SPARS), searched lazily
};

/// The recalling half of an experience planner of OMPL; the other half, planning from scratch in a
/// second thread, is plan_with_ompl's RRTConnect. Each half counts its own checks, so a caller that
/// runs them in turn can add up the checks of two threads.
///
/// OMPL's databases, retrieval and repair with three differences, all in their favour: the query
/// ends at its first path (Lightning would shorten it first), recall considers every goal (OMPL
/// only the first), and no other thread runs beside it. Not shared between threads. Silences OMPL's
/// messages for the process.
class OmplExperience {
 public:
  /// \param bounds  2 x dof: lower, upper, joint units; for every path and query.
  /// \param step    between checked configurations, joint units.
  /// \param range   longest extension of the RRTConnect that repairs; 0: OMPL's choice.
  /// \throws std::invalid_argument for an invalid bound, step or range.
  OmplExperience(ExperienceKind kind, const Eigen::Matrix2Xd& bounds, double step, double range);
  ~OmplExperience();
  OmplExperience(const OmplExperience&) = delete;
  OmplExperience& operator=(const OmplExperience&) = delete;

  /// Learns a path in its scene.
  /// \param waypoints  dof x n, n >= 2.
  /// \param is_free    of the path's scene: Thunder checks while it builds its roadmap.
  /// \return           whether OMPL kept the whole path.
  bool learn(const Eigen::MatrixXd& waypoints, const planning::IsFree& is_free);

  /// Paths of Lightning, vertices of Thunder's roadmap.
  std::size_t size() const;
  /// Configurations checked while learning.
  std::uint64_t learning_checks() const;

  /// Answers one query from experience alone. Counts checks as plan_birrt, including start and
  /// goals, which OMPL checks once more; the path is checked again, uncounted. Reasons as
  /// plan_birrt, NothingRecalled if retrieval and repair gave up, RecallCollides if OMPL's path is
  /// invalid.
  /// \throws Failure(Internal) with the message of OMPL's exception.
  planning::PlanSummary recall(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                               const planning::IsFree& is_free,
                               const planning::BirrtOptions& limits, std::mt19937_64& generator);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::ompl_planners
