#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>

#include "robots/planning/is_free.hpp"
#include "robots/planning/no_path.hpp"

namespace kinship::planning {

/// CPU time of the calling thread, s.
double thread_time_s();

/// Asks whether configurations are free until checks or time are used up. The limit is wall-clock
/// time, what was spent is CPU time of the thread. Lives on one thread.
class PlanningBudget {
 public:
  /// \param is_free  must outlive this.
  PlanningBudget(const IsFree& is_free, std::uint64_t max_checks,
                 std::chrono::duration<double> time_limit);

  /// False also if the budget is used up; then nothing was asked.
  bool is_free(const Eigen::VectorXd& q) {
    if (exhausted())
      return false;
    ++checks_;
    return is_free_(q);
  }

  bool exhausted();

  double thread_time_s() const { return planning::thread_time_s() - thread_begin_s_; }
  std::uint64_t checks() const noexcept { return checks_; }
  /// MaxChecks or TimeLimit; None as long as it is not used up.
  NoPath reason() const noexcept { return reason_; }

 private:
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
