#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>

#include "robots/planning/birrt.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/shortcut.hpp"

namespace kinship::planning {

/// Shortens a path. Equal arguments, equal answers.
/// \param waypoints  dof x n
using Shorten =
    std::function<ShortcutSummary(const Eigen::MatrixXd& waypoints, const IsFree& is_free)>;

/// Plans from one configuration to another, both free, by checks that are at most `step` apart,
/// joint units.
using PlanBetween =
    std::function<PlanSummary(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double step)>;

/// A way from one configuration to another, both free, over one between them, proven: for where the
/// straight line is only just not free. A few are tried, near the middle of the line.
/// \param bounds  2 x dof, joint units
/// \param checks  out: configurations asked about are added
/// \return dof x 3; nothing if none was found
std::optional<Eigen::MatrixXd> detour(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                                      const IsFree& is_free, const Eigen::Matrix2Xd& bounds,
                                      std::mt19937_64& generator, std::uint64_t& checks);

/// What came of shortening a path and proving it.
struct ProvenPath {
  Eigen::MatrixXd waypoints;     ///< dof x n, each line between two proven; empty if there is none
  NoPath reason = NoPath::None;  ///< why there is none
  /// The least that IsFree::edges said of its lines, m.
  double least_clearance_m = std::numeric_limits<double>::infinity();
  std::uint64_t refuted_edges = 0;  ///< lines that are not free though their checks were
  std::uint64_t shortcut_checks = 0;
  std::uint64_t collision_checks = 0;  ///< of planning again
  std::uint64_t projections = 0;
};

/// Shortens a path by checks, then proves the lines that are left of it. One that is refuted is not
/// taken again: the path is shortened anew without it. If the path itself has it, it is planned
/// again between its ends, in finer steps: what the search had called free between two checks is
/// then seen by one. Since both ends are free and proven to be reached, no path is lost by planning
/// only between them.
/// \param waypoints  dof x n, n >= 1, each free and each line free by its checks
/// \param step       between the checks that they come from, joint units
/// \param is_free    decides, if it proves lines; else every line is taken as it is
/// \return reason EdgesRefuted if a line is still refuted where steps are finest, or that of a plan
///         that came to nothing
ProvenPath shorten_and_prove(const Eigen::MatrixXd& waypoints, double step, const IsFree& is_free,
                             const Shorten& shorten, const PlanBetween& plan);

}  // namespace kinship::planning
