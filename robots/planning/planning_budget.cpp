#include "robots/planning/planning_budget.hpp"

#include <ctime>

namespace kinship::planning {

double thread_time_s() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

PlanningBudget::PlanningBudget(const IsFree& is_free, std::uint64_t max_checks,
                               std::chrono::duration<double> time_limit)
    : is_free_(is_free),
      max_checks_(max_checks),
      begin_(Clock::now()),
      time_limit_(time_limit),
      thread_begin_s_(planning::thread_time_s()) {}

Eigen::Index PlanningBudget::free_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  if (exhausted())
    return 0;
  const Eigen::Index left = left_of(qs.cols());
  const Eigen::Index free = is_free_.ahead(qs.leftCols(left));
  checks_ += static_cast<std::uint64_t>(std::min(free + 1, left));
  return free;
}

std::optional<Eigen::Index> PlanningBudget::first_free(
    const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  if (exhausted())
    return std::nullopt;
  const Eigen::Index left = left_of(qs.cols());
  const Eigen::Index blocked = is_free_.blocked_ahead(qs.leftCols(left));
  checks_ += static_cast<std::uint64_t>(std::min(blocked + 1, left));
  return blocked < left ? std::optional(blocked) : std::nullopt;
}

bool PlanningBudget::exhausted() {
  if (reason_ != NoPath::None)
    return true;
  if (checks_ >= max_checks_)
    reason_ = NoPath::MaxChecks;
  else if (Clock::now() - begin_ >= time_limit_)
    reason_ = NoPath::TimeLimit;
  return reason_ != NoPath::None;
}

}  // namespace kinship::planning
