#include "robots/planning/shortcut.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "robots/planning/path_vertices.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::planning {
namespace {

constexpr int kMaxFruitlessTries = 500;
constexpr double kMinGain = 1e-6;  // joint units: less is rounding

/// A path that gets shorter, with the length up to each of its configurations.
class ShorterPath {
 public:
  /// \param waypoints  dof x n, every configuration that was checked.
  explicit ShorterPath(Eigen::MatrixXd waypoints)
      : waypoints_(std::move(waypoints)), size_(waypoints_.cols()) {
    add_up(0);
  }

  Eigen::Index size() const { return size_; }
  Eigen::MatrixXd::ConstColXpr at(Eigen::Index i) const { return waypoints_.col(i); }
  double length(Eigen::Index from, Eigen::Index to) const { return length_[to] - length_[from]; }
  Eigen::MatrixXd waypoints() const { return waypoints_.leftCols(size_); }

  /// Replaces the waypoints between two configurations by a way between them.
  template <typename Way>
  void replace(Eigen::Index from, Eigen::Index to, const Way& way) {
    const Eigen::Index end = from + way.parts(), tail = size_ - to;
    if (end + tail > waypoints_.cols())
      waypoints_.conservativeResize(Eigen::NoChange, 2 * (end + tail));
    double* const data = waypoints_.data();
    const Eigen::Index dof = waypoints_.rows();
    std::memmove(data + end * dof, data + to * dof,
                 static_cast<std::size_t>(tail * dof) * sizeof(double));
    for (Eigen::Index i = 1; i < way.parts(); ++i)
      way.write(i, waypoints_.col(from + i));
    size_ = end + tail;
    add_up(from);
  }

 private:
  void add_up(Eigen::Index from) {
    length_.conservativeResize(waypoints_.cols());
    length_[0] = 0;
    for (Eigen::Index i = from + 1; i < size_; ++i)
      length_[i] = length_[i - 1] + (waypoints_.col(i) - waypoints_.col(i - 1)).norm();
  }

  Eigen::MatrixXd waypoints_;  // dof x capacity
  Eigen::VectorXd length_;
  Eigen::Index size_;
};

/// The straight way between two configurations, as `densified` cuts it.
class StraightWay {
 public:
  StraightWay(Eigen::Index dof, double step) : step_(step), from_(dof), to_(dof) {}

  bool connect(const Eigen::Ref<const Eigen::VectorXd>& from,
               const Eigen::Ref<const Eigen::VectorXd>& to, double) {
    from_ = from;
    to_ = to;
    parts_ = count_of_parts((to_ - from_).norm(), step_);
    return true;
  }
  bool is_proven(const IsFree& is_free) const { return is_free.edges(from_, to_).front(); }
  Eigen::Index parts() const { return parts_; }
  /// \param i  0 to parts()
  void write(Eigen::Index i, Eigen::Ref<Eigen::VectorXd> q) const {
    q = from_ + (to_ - from_) * (static_cast<double>(i) / static_cast<double>(parts_));
  }

 private:
  double step_;
  Eigen::VectorXd from_, to_;
  Eigen::Index parts_ = 1;
};

/// A way along a region.
class SlidingWay {
 public:
  SlidingWay(double step, RegionConstraint& constraint) : stepper_(step, constraint) {}

  /// \return whether there is one that is shorter than a length.
  bool connect(const Eigen::Ref<const Eigen::VectorXd>& from,
               const Eigen::Ref<const Eigen::VectorXd>& to, double max_length) {
    way_ = {from};
    const Eigen::VectorXd target = to;
    Eigen::VectorXd next(from.size());
    double length = 0;
    while (!stepper_.joins(way_.back(), target)) {
      if (!stepper_.advance(way_.back(), target, next))
        return false;
      length += (next - way_.back()).norm();
      way_.push_back(next);
      if (length + (target - next).norm() >= max_length)
        return false;
    }
    way_.push_back(target);
    return true;
  }
  bool is_proven(const IsFree& is_free) const {
    if (!is_free.proves_edges())
      return true;
    Eigen::MatrixXd way(way_.front().size(), parts() + 1);
    for (Eigen::Index i = 0; i < way.cols(); ++i)
      write(i, way.col(i));
    return is_free.way_is_free(way);
  }
  Eigen::Index parts() const { return static_cast<Eigen::Index>(way_.size()) - 1; }
  void write(Eigen::Index i, Eigen::Ref<Eigen::VectorXd> q) const {
    q = way_[static_cast<std::size_t>(i)];
  }

 private:
  ConstrainedStepper stepper_;
  std::vector<Eigen::VectorXd> way_;
};

/// Asks for every configuration of a way but its ends, a few at a time.
/// \param asked  room for kTogether configurations.
template <typename Way>
bool way_is_free(const Way& way, const IsFree& is_free, Eigen::MatrixXd& asked,
                 std::uint64_t& checks) {
  MiddlesFirst middles(way.parts());
  Eigen::Index next = middles.next();
  for (Eigen::Index together = kFewTogether; next != 0; together = kTogether) {
    Eigen::Index count = 0;
    for (; count < together && next != 0; next = middles.next())
      way.write(next, asked.col(count++));
    const Eigen::Index free = is_free.ahead(asked.leftCols(count));
    checks += static_cast<std::uint64_t>(std::min(free + 1, count));
    if (free < count)
      return false;
  }
  return true;
}

/// \param waypoints  dof x n, every configuration that was checked.
/// \param way        connects two of them by a way that is shorter than a length, if there is one;
///                   asks no collision question.
template <typename Way>
ShortcutSummary shorten(Eigen::MatrixXd waypoints, const IsFree& is_free,
                        const ShortcutOptions& options, std::mt19937_64& generator, Way way) {
  ShortcutSummary summary;
  Eigen::MatrixXd asked(waypoints.rows(), kTogether);
  ShorterPath path(std::move(waypoints));
  int fruitless = 0;
  while (path.size() > 2 && fruitless < kMaxFruitlessTries &&
         summary.collision_checks < options.max_checks) {
    ++fruitless;
    std::uniform_int_distribution<Eigen::Index> index(0, path.size() - 1);
    const Eigen::Index a = index(generator), b = index(generator);
    const Eigen::Index from = std::min(a, b), to = std::max(a, b);
    if (to - from < 2)
      continue;
    const double shorter = path.length(from, to) - kMinGain;
    if ((path.at(to) - path.at(from)).norm() >= shorter ||
        !way.connect(path.at(from), path.at(to), shorter))
      continue;
    const auto needed = static_cast<std::uint64_t>(way.parts() - 1);
    if (summary.collision_checks + needed > options.max_checks ||
        !way_is_free(way, is_free, asked, summary.collision_checks) || !way.is_proven(is_free))
      continue;
    path.replace(from, to, way);
    fruitless = 0;
  }
  summary.waypoints = path.waypoints();
  return summary;
}

}  // namespace

ShortcutSummary shortcut(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                         const ShortcutOptions& options, std::mt19937_64& generator) {
  ShortcutSummary summary = shorten(densified(waypoints, options.step), is_free, options, generator,
                                    StraightWay(waypoints.rows(), options.step));
  summary.waypoints = sparse_vertices(summary.waypoints, options.step);
  return summary;
}

ShortcutSummary shortcut_constrained(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                                     RegionConstraint& constraint, const ShortcutOptions& options,
                                     std::mt19937_64& generator) {
  if (waypoints.cols() < 1 || !(options.step > 0))
    throw std::invalid_argument("path: no waypoint, or a step that is not positive");
  const std::uint64_t before = constraint.projections();
  ShortcutSummary summary =
      shorten(waypoints, is_free, options, generator, SlidingWay(options.step, constraint));
  summary.projections = constraint.projections() - before;
  return summary;
}

ShortcutSummary shortcut(const Eigen::MatrixXd& waypoints, const IsFree& is_free,
                         RegionConstraint* constraint, const ShortcutOptions& options,
                         std::mt19937_64& generator) {
  return constraint != nullptr
             ? shortcut_constrained(waypoints, is_free, *constraint, options, generator)
             : shortcut(waypoints, is_free, options, generator);
}

}  // namespace kinship::planning
