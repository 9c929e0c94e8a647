#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
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

/// A proven way from one configuration to another, both free, over one between them, for a straight
/// line that is only just not free. It tries a few, near the middle of the line.
/// \param bounds  2 x dof, joint units
/// \param checks  out: the checked configurations are added
/// \return dof x 3; empty if none was found
std::optional<Eigen::MatrixXd> detour(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                                      const IsFree& is_free, const Eigen::Matrix2Xd& bounds,
                                      std::mt19937_64& generator, std::uint64_t& checks);

/// A path after shortening and proof.
struct ProvenPath {
  Eigen::MatrixXd waypoints;     ///< dof x n, each line between two proven; empty if there is none
  NoPath reason = NoPath::None;  ///< why there is none
  std::uint64_t refuted_edges = 0;  ///< lines that are not free though their checks were
  std::uint64_t shortcut_checks = 0;
  std::uint64_t collision_checks = 0;  ///< of replanning
  std::uint64_t projections = 0;
};

/// Shortens a path by checks, then proves its remaining lines. After a refuted line the path is
/// shortened again without that line. A refuted line of the path itself is replanned between its
/// ends, in finer steps: a check then hits the collision that the search missed between two checks.
/// Since both ends are free and proven to be reached, no path is lost by planning only between
/// them.
/// \param waypoints  dof x n, n >= 1, each free and each line free by its checks
/// \param step       between the checks that they come from, joint units
/// \param is_free    decides, if it proves lines; else every line counts as free
/// \return reason EdgesRefuted if a line is still refuted where steps are finest, or that of a
///         failed plan
ProvenPath shorten_and_prove(const Eigen::MatrixXd& waypoints, double step, const IsFree& is_free,
                             const Shorten& shorten, const PlanBetween& plan);

}  // namespace kinship::planning
