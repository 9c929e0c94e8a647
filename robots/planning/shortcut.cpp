#include "robots/planning/shortcut.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "robots/planning/constrained_stepper.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::planning {
namespace {

constexpr int kMaxFruitlessTries = 500;
constexpr double kMinGain = 1e-6;  // joint units: less is rounding

/// Asks for every configuration of a line but its ends, the middle first, then the middles of
/// the halves, and so on: what stands in the way is found early.
bool line_is_free(const Eigen::MatrixXd& line, const IsFree& is_free, std::uint64_t& checks) {
  const Eigen::Index count = line.cols() - 1;
  Eigen::Index stride = 1;
  while (stride < count)
    stride *= 2;
  for (stride /= 2; stride >= 1; stride /= 2)
    for (Eigen::Index i = stride; i < count; i += 2 * stride) {
      ++checks;
      if (!is_free(line.col(i)))
        return false;
    }
  return true;
}

/// `path` with what lies between two of its columns replaced by a line that has both as ends.
Eigen::MatrixXd replaced(const Eigen::MatrixXd& path, Eigen::Index from, Eigen::Index to,
                         const Eigen::MatrixXd& line) {
  Eigen::MatrixXd result(path.rows(), from + line.cols() + path.cols() - to - 1);
  result << path.leftCols(from), line, path.rightCols(path.cols() - to - 1);
  return result;
}

/// \param path     dof x n, every configuration that was checked.
/// \param connect  the configurations of a way between two of them, ends included, that is shorter
///                 than a length; empty if there is none. Asks no collision question.
template <typename Connect>
ShortcutSummary shorten(Eigen::MatrixXd path, const IsFree& is_free, const ShortcutOptions& options,
                        std::mt19937_64& generator, Connect connect) {
  ShortcutSummary summary;
  int fruitless = 0;
  while (path.cols() > 2 && fruitless < kMaxFruitlessTries &&
         summary.collision_checks < options.max_checks) {
    ++fruitless;
    std::uniform_int_distribution<Eigen::Index> index(0, path.cols() - 1);
    const Eigen::Index a = index(generator), b = index(generator);
    const Eigen::Index from = std::min(a, b), to = std::max(a, b);
    if (to - from < 2)
      continue;
    const double before = path_length(path.middleCols(from, to - from + 1));
    if ((path.col(to) - path.col(from)).norm() >= before - kMinGain)
      continue;
    const Eigen::MatrixXd line = connect(path.col(from), path.col(to), before - kMinGain);
    if (line.cols() == 0)
      continue;
    const auto needed = static_cast<std::uint64_t>(line.cols() - 2);
    if (summary.collision_checks + needed > options.max_checks)
      continue;
    if (!line_is_free(line, is_free, summary.collision_checks))
      continue;
    path = replaced(path, from, to, line);
    fruitless = 0;
  }
  summary.waypoints = std::move(path);
  return summary;
}

/// A way along the region: dof x n with both ends, or dof x 0.
Eigen::MatrixXd slide(ConstrainedStepper& stepper, const Eigen::VectorXd& from,
                      const Eigen::VectorXd& to, double max_length) {
  std::vector<Eigen::VectorXd> way = {from};
  Eigen::VectorXd next(from.size());
  double length = 0;
  while (!stepper.joins(way.back(), to)) {
    if (!stepper.advance(way.back(), to, next))
      return Eigen::MatrixXd(from.size(), 0);
    length += (next - way.back()).norm();
    way.push_back(next);
    if (length + (to - next).norm() >= max_length)
      return Eigen::MatrixXd(from.size(), 0);
  }
  way.push_back(to);
  Eigen::MatrixXd line(from.size(), static_cast<Eigen::Index>(way.size()));
  for (std::size_t i = 0; i < way.size(); ++i)
    line.col(static_cast<Eigen::Index>(i)) = way[i];
  return line;
}

}  // namespace

ShortcutSummary shortcut(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                         const ShortcutOptions& options, std::mt19937_64& generator) {
  const auto straight = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to, double) {
    Eigen::MatrixXd ends(from.size(), 2);
    ends << from, to;
    return densified(ends, options.step);
  };
  ShortcutSummary summary =
      shorten(densified(waypoints, options.step), is_free, options, generator, straight);
  summary.waypoints = sparse_vertices(summary.waypoints, options.step);
  return summary;
}

ShortcutSummary shortcut_constrained(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                                     RegionConstraint& constraint, const ShortcutOptions& options,
                                     std::mt19937_64& generator) {
  if (waypoints.cols() < 1 || !(options.step > 0))
    throw std::invalid_argument("path: no waypoint, or a step that is not positive");
  const std::uint64_t before = constraint.projections();
  ConstrainedStepper stepper(options.step, constraint);
  const auto along = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                         double max_length) { return slide(stepper, from, to, max_length); };
  ShortcutSummary summary = shorten(waypoints, is_free, options, generator, along);
  summary.projections = constraint.projections() - before;
  return summary;
}

}  // namespace kinship::planning
