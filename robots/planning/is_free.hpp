#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"

namespace kinship::planning {

/// Whether configurations are free; counts them itself. Each question is one collision check,
/// whatever answers it.
class IsFree {
 public:
  /// \return whether a configuration is free.
  using One = std::function<bool(const Eigen::VectorXd& q)>;
  /// \param qs  dof x n. \return how many of them, from the first on, answer alike before one does
  /// not; later ones are not looked at, or as if they were not.
  using Ahead = std::function<Eigen::Index(const Eigen::Ref<const Eigen::MatrixXd>& qs)>;
  /// How near to touching each of some straight lines comes, m, as far as that had to be measured,
  /// else infinity; nothing of one that is not free all along.
  using Lines = std::vector<std::optional<double>>;
  /// \param from, to  dof x n: the ends of the lines, a column each
  using Edges = std::function<Lines(const Eigen::Ref<const Eigen::MatrixXd>& from,
                                    const Eigen::Ref<const Eigen::MatrixXd>& to)>;

  /// Several are asked for one after the other.
  template <typename Callable>
  requires std::predicate<Callable&, const Eigen::VectorXd&> IsFree(
      Callable one)  // NOLINT(google-explicit-constructor): a function is all that most have
      : one_(std::move(one)) {}

  /// \param free     says how many are free before one is not.
  /// \param blocked  says how many are not before one is; none: asked for one by one.
  /// \param edges    proves lines; none: what was asked about along a line has to do.
  IsFree(One one, Ahead free, Ahead blocked = {}, Edges edges = {})
      : one_(std::move(one)),
        free_(std::move(free)),
        blocked_(std::move(blocked)),
        edges_(std::move(edges)) {}

  bool operator()(const Eigen::VectorXd& q) const { return one_(q); }

  /// How many are free, from the first on, before one is not.
  Eigen::Index ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) const {
    return free_ ? free_(qs) : alike(qs, true);
  }

  /// Whether lines are proven, and edges() decides.
  bool proves_edges() const { return static_cast<bool>(edges_); }

  /// As Edges says; infinity where lines are not proven. Counts no check.
  Lines edges(const Eigen::Ref<const Eigen::MatrixXd>& from,
              const Eigen::Ref<const Eigen::MatrixXd>& to) const {
    if (edges_)
      return edges_(from, to);
    return Lines(static_cast<std::size_t>(from.cols()), std::numeric_limits<double>::infinity());
  }

  /// Whether all lines between the columns of a way are free.
  bool way_is_free(const Eigen::Ref<const Eigen::MatrixXd>& way) const {
    const auto lines = edges(way.leftCols(way.cols() - 1), way.rightCols(way.cols() - 1));
    return std::ranges::all_of(lines, [](const auto& line) { return line.has_value(); });
  }

  /// The same, but for what is said of lines.
  IsFree with_edges(Edges edges) const { return {one_, free_, blocked_, std::move(edges)}; }

  /// How many are not free, from the first on, before one is.
  Eigen::Index blocked_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) const {
    return blocked_ ? blocked_(qs) : alike(qs, false);
  }

 private:
  Eigen::Index alike(const Eigen::Ref<const Eigen::MatrixXd>& qs, bool free) const {
    Eigen::Index count = 0;
    while (count < qs.cols() && one_(qs.col(count)) == free)
      ++count;
    return count;
  }

  One one_;
  Ahead free_, blocked_;
  Edges edges_;
};

/// As many configurations as are asked for together, and as few as cost less together.
inline constexpr Eigen::Index kTogether = 16, kFewTogether = 8;

/// Whether configurations are free in a world, several at once at the cost of little more than one.
/// \param world   must outlive what is returned, which counts in it.
/// \param before  called before each question; what it throws goes to who asks.
IsFree free_in(collision::CollisionWorld& world, std::function<void()> before = {});

/// The same, but what comes nearer than a clearance counts as touching, and lines are proven.
/// \param prover  must outlive what is returned.
IsFree proven_in(collision::EdgeProver& prover, const collision::EdgeProofOptions& options,
                 std::function<void()> before = {});

}  // namespace kinship::planning
