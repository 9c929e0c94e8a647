#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>

#include "robots/planning/birrt.hpp"
#include "robots/planning/is_free.hpp"

namespace kinship::planning {

/// The planners of OMPL that remember paths of the robot that plans.
enum class ExperienceKind {
  Lightning,  ///< whole paths: the one that fits best is repaired
  Thunder     ///< a sparse roadmap made of them (SPARS), searched lazily
};

/// The half of an experience planner of OMPL that recalls; the other half, planning from scratch in
/// a second thread, is plan_with_ompl's RRTConnect. Both halves count by themselves, so who runs
/// them in turn can say what two threads would have asked together.
///
/// OMPL's databases, retrieval and repair as they come, with three differences, all in their
/// favour: the query ends at its first path (Lightning would shorten it before it is known), every
/// goal may be recalled to (OMPL looks at the first only), and nothing else runs beside it. Not
/// shared between threads. Silences OMPL's messages for the process.
class OmplExperience {
 public:
  /// \param bounds  2 x dof: lower, upper, joint units; of every path and query.
  /// \param step    between checked configurations, joint units.
  /// \param range   longest extension of the RRTConnect that repairs; 0: OMPL's choice.
  /// \throws std::invalid_argument if a bound, the step or the range cannot be used.
  OmplExperience(ExperienceKind kind, const Eigen::Matrix2Xd& bounds, double step, double range);
  ~OmplExperience();
  OmplExperience(const OmplExperience&) = delete;
  OmplExperience& operator=(const OmplExperience&) = delete;

  /// Learns a path where it was planned.
  /// \param waypoints  dof x n, n >= 2.
  /// \param is_free    of the scene of the path: Thunder asks while it builds its roadmap.
  /// \return           whether OMPL says that all of it was kept.
  bool learn(const Eigen::MatrixXd& waypoints, const IsFree& is_free);

  /// Paths of Lightning, vertices of Thunder's roadmap.
  std::size_t size() const;
  /// Configurations asked about while learning.
  std::uint64_t learning_checks() const;

  /// Answers one query from experience alone. Counts as plan_birrt does, start and goals included,
  /// which OMPL asks about once more; a path is looked at once more, uncounted. Reasons as
  /// plan_birrt, NothingRecalled if retrieval and repair gave up, RecallCollides if OMPL's path is
  /// none. \throws Failure(Internal) with OMPL's message where it throws.
  PlanSummary recall(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                     const IsFree& is_free, const BirrtOptions& limits, std::mt19937_64& generator);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::planning
