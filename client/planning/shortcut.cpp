#include "client/planning/shortcut.hpp"

#include <algorithm>

#include "client/planning/path_vertices.hpp"

namespace kinship::planning {
namespace {

constexpr int kMaxFruitlessTries = 500;
constexpr double kLeastGain = 1e-6;  // joint units: less is rounding

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

}  // namespace

ShortcutSummary shortcut(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                         const ShortcutOptions& options, std::mt19937_64& generator) {
  Eigen::MatrixXd path = densified(waypoints, options.step);
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
    if ((path.col(to) - path.col(from)).norm() >= before - kLeastGain)
      continue;
    Eigen::MatrixXd ends(path.rows(), 2);
    ends << path.col(from), path.col(to);
    const Eigen::MatrixXd line = densified(ends, options.step);
    const auto needed = static_cast<std::uint64_t>(line.cols() - 2);
    if (summary.collision_checks + needed > options.max_checks)
      continue;
    if (!line_is_free(line, is_free, summary.collision_checks))
      continue;
    path = replaced(path, from, to, line);
    fruitless = 0;
  }
  summary.waypoints = sparse_vertices(path, options.step);
  return summary;
}

}  // namespace kinship::planning
