#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "robots/planning/is_free.hpp"
#include "robots/planning/no_path.hpp"

namespace kinship::planning {

/// CPU time of the calling thread, s.
double thread_time_s();

/// Checks configurations until checks or time are used up. The limit is wall-clock time, the time
/// spent is CPU time of the thread. Used by one thread.
class PlanningBudget {
 public:
  /// \param is_free  must outlive this.
  PlanningBudget(const IsFree& is_free, std::uint64_t max_checks,
                 std::chrono::duration<double> time_limit);

  /// False also if the budget is used up; then nothing is checked.
  bool is_free(const Eigen::VectorXd& q) {
    if (exhausted())
      return false;
    ++checks_;
    return is_free_(q);
  }

  /// How many configurations, from the first on, are free before one is not; the check of that one
  /// counts too. Fewer if the budget is used up: checks end at the limit, but the time is tested
  /// only before the first one.
  /// \param qs  dof x n, some kTogether
  Eigen::Index free_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs);

  /// Index of the first free configuration; counts it and those before it. Empty if none is free,
  /// or if the budget is used up before.
  /// \param qs  dof x n, some kTogether
  std::optional<Eigen::Index> first_free(const Eigen::Ref<const Eigen::MatrixXd>& qs);

  /// Whether all of some configurations are free. Counts them, or one that is not. False also if
  /// the budget is used up before.
  bool all_free(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
    if (exhausted())
      return false;
    const bool all = is_free_.all(qs);
    checks_ += all ? static_cast<std::uint64_t>(qs.cols()) : 1;
    return all;
  }

  bool exhausted();

  double thread_time_s() const { return planning::thread_time_s() - thread_begin_s_; }
  std::uint64_t checks() const noexcept { return checks_; }
  /// MaxChecks or TimeLimit; None as long as it is not used up.
  NoPath reason() const noexcept { return reason_; }

 private:
  /// How many of `wanted` configurations may be checked.
  Eigen::Index left_of(Eigen::Index wanted) const {
    return static_cast<Eigen::Index>(
        std::min<std::uint64_t>(max_checks_ - checks_, static_cast<std::uint64_t>(wanted)));
  }

  using Clock = std::chrono::steady_clock;

  const IsFree& is_free_;
  std::uint64_t max_checks_;
  Clock::time_point begin_;
  std::chrono::duration<double> time_limit_;
  double thread_begin_s_;
  std::uint64_t checks_ = 0;
  NoPath reason_ = NoPath::None;
};

}  // namespace kinship::planning
