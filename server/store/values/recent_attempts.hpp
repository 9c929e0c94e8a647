#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/store.hpp"
#include "server/store/values/columns.hpp"

namespace kinship::store {

/// Newest attempts that are searched; a mode without attempts among them counts as unknown.
inline constexpr std::int64_t kMaxRecentRows = 10'000;

/// Collects the newest judged attempts of each sampling mode.
class RecentAttempts {
 public:
  static constexpr std::string_view kColumns =
      "sampling_mode, outcome, collision_checks, planner, distribution_digest, processor_time_s,"
      " machine_speed ";

  bool complete() const { return std::min(guided_, control_) >= kKnownAttemptsPerMode; }

  /// \param row  of kColumns, newest first.
  template <Columns Row>
  void add(const Row& row) {
    const SamplingMode mode = mode_of(row.column_integer(0));
    const Outcome outcome = outcome_of(row.column_integer(1));
    if (mode == SamplingMode::Uniform || outcome == Outcome::Failed)
      return;
    if ((mode == SamplingMode::Guided ? guided_ : control_)++ < kKnownAttemptsPerMode)
      newest_first_.push_back({.judged = {.sampling_mode = mode,
                                          .solved = outcome == Outcome::Solved,
                                          .checks = count_of(row, 2),
                                          .age = age_,
                                          .time_s = row.column_real(5) * row.column_real(6)},
                               .planner = std::string(row.column_text(3)),
                               .distribution_id = optional_id_of<Digest>(row, 4)});
    ++age_;
  }
  std::vector<KnownAttempt> oldest_first() const {
    return {newest_first_.rbegin(), newest_first_.rend()};
  }

 private:
  std::vector<KnownAttempt> newest_first_;
  std::size_t guided_ = 0, control_ = 0;
  std::uint32_t age_ = 0;
};

/// The sums of both sampling modes in `experience`, for read_totals().
inline constexpr std::string_view kTotalsColumns =
    "guided_attempts, guided_solved, guided_checks, guided_checks_squared,"
    " guided_checks_of_solved, control_attempts, control_solved, control_checks,"
    " control_checks_squared, control_checks_of_solved ";

/// Without the recent ones. \param row  of kTotalsColumns.
template <Columns Row>
AttemptTotals read_totals(const Row& row) {
  const auto read = [&](int first) {
    return ModeTotals{count_of(row, first), count_of(row, first + 1), row.column_real(first + 2),
                      row.column_real(first + 3), row.column_real(first + 4)};
  };
  constexpr int kControl = 5;
  return {read(0), read(kControl), {}};
}

}  // namespace kinship::store
