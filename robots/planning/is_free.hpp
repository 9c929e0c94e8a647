#pragma once

#include <Eigen/Core>
#include <concepts>
#include <functional>
#include <utility>

#include "robots/collision/collision_world.hpp"

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

  /// Several are asked for one after the other.
  template <typename Callable>
  requires std::predicate<Callable&, const Eigen::VectorXd&> IsFree(
      Callable one)  // NOLINT(google-explicit-constructor): a function is all that most have
      : one_(std::move(one)) {}

  /// \param free     says how many are free before one is not.
  /// \param blocked  says how many are not before one is; none: asked for one by one.
  IsFree(One one, Ahead free, Ahead blocked = {})
      : one_(std::move(one)), free_(std::move(free)), blocked_(std::move(blocked)) {}

  bool operator()(const Eigen::VectorXd& q) const { return one_(q); }

  /// How many are free, from the first on, before one is not.
  Eigen::Index ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) const {
    return free_ ? free_(qs) : alike(qs, true);
  }

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
};

/// As many configurations as are asked for together, and as few as cost less together.
inline constexpr Eigen::Index kTogether = 16, kFewTogether = 8;

/// Whether configurations are free in a world, several at once at the cost of little more than one.
/// \param world   must outlive what is returned, which counts in it.
/// \param before  called before each question; what it throws goes to who asks.
IsFree free_in(collision::CollisionWorld& world, std::function<void()> before = {});

}  // namespace kinship::planning
