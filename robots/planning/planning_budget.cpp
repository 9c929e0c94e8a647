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
