#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <concepts>
#include <functional>
#include <utility>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"

namespace kinship::planning {

/// Whether configurations are free. Each checked configuration is one collision check, whichever
/// function answers.
class IsFree {
 public:
  /// \return whether a configuration is free.
  using One = std::function<bool(const Eigen::VectorXd& q)>;
  /// \param qs  dof x n. \return how many, from the first on, have the same answer (free or
  ///            blocked) before one differs; later ones are not checked, or without effect.
  using Ahead = std::function<Eigen::Index(const Eigen::Ref<const Eigen::MatrixXd>& qs)>;
  /// \param qs  dof x n. \return whether all are free.
  using All = std::function<bool(const Eigen::Ref<const Eigen::MatrixXd>& qs)>;
  /// Whether each of some straight lines is free.
  using Lines = std::vector<bool>;
  /// \param from, to  dof x n: the ends of the lines, a column each
  using Edges = std::function<Lines(const Eigen::Ref<const Eigen::MatrixXd>& from,
                                    const Eigen::Ref<const Eigen::MatrixXd>& to)>;

  /// Several configurations are checked one after the other.
  template <typename Callable>
  requires std::predicate<Callable&, const Eigen::VectorXd&> IsFree(
      Callable one)  // NOLINT(google-explicit-constructor): a function is all that most have
      : one_(std::move(one)) {}

  /// \param free     returns how many are free before one is not.
  /// \param blocked  returns how many are not before one is; none: checked one by one.
  /// \param edges    proves lines; none: the configurations checked along a line suffice.
  /// \param all      none: as free
  IsFree(One one, Ahead free, Ahead blocked = {}, Edges edges = {}, All all = {})
      : one_(std::move(one)),
        free_(std::move(free)),
        blocked_(std::move(blocked)),
        edges_(std::move(edges)),
        all_(std::move(all)) {}

  bool operator()(const Eigen::VectorXd& q) const { return one_(q); }

  /// How many are free, from the first on, before one is not.
  Eigen::Index ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) const {
    return free_ ? free_(qs) : alike(qs, true);
  }

  /// Whether all are free.
  bool all(const Eigen::Ref<const Eigen::MatrixXd>& qs) const {
    return all_ ? all_(qs) : ahead(qs) == qs.cols();
  }

  /// Whether lines are proven, and edges() decides.
  bool proves_edges() const { return static_cast<bool>(edges_); }

  /// As Edges; all are if lines are not proven. Counts no check.
  Lines edges(const Eigen::Ref<const Eigen::MatrixXd>& from,
              const Eigen::Ref<const Eigen::MatrixXd>& to) const {
    if (edges_)
      return edges_(from, to);
    return Lines(static_cast<std::size_t>(from.cols()), true);
  }

  /// Whether all lines between the columns of a way are free.
  bool way_is_free(const Eigen::Ref<const Eigen::MatrixXd>& way) const {
    const auto lines = edges(way.leftCols(way.cols() - 1), way.rightCols(way.cols() - 1));
    return std::ranges::all_of(lines, std::identity());
  }

  /// The same with another proof of lines.
  IsFree with_edges(Edges edges) const { return {one_, free_, blocked_, std::move(edges), all_}; }

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
  All all_;
};

/// Configurations checked together at most, and the fewest that cost less together.
inline constexpr Eigen::Index kTogether = 16, kFewTogether = 8;

/// Whether configurations are free in a world, several at once at the cost of little more than one.
/// \param world   must outlive the returned object; counts the checks.
/// \param before  called before each call; its exceptions reach the caller.
IsFree free_in(collision::CollisionWorld& world, std::function<void()> before = {});

/// The same, but bodies nearer than a clearance count as touching, and lines are proven.
/// \param prover  must outlive the returned object.
IsFree proven_in(collision::EdgeProver& prover, const collision::EdgeProofOptions& options,
                 std::function<void()> before = {});

}  // namespace kinship::planning
