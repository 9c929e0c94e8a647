#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/bench/season_logs.hpp"

/// Seasons of queries played from logs: which arm a client takes depends on what came before, what
/// a query costs in an arm does not. So a season played from plans that were made once is exactly
/// the season that would have been planned.
namespace kinship::bench {

inline constexpr std::size_t kSeasonQueries = 200;
inline constexpr std::size_t kChange = 100;  ///< queries before guidance changes

/// What guides a task's queries, before and after the change.
struct SeasonCase {
  std::string name;
  Guide first = Guide::Good;
  Guide second = Guide::Good;
};

/// The cases of one task: good, wrong in three ways, and each change between them.
std::vector<SeasonCase> season_cases();

/// Sums over all seasons: collision checks of the client, and of plans of the same queries.
struct SeasonScore {
  double client = 0, uniform = 0, guided = 0;

  double against_uniform() const { return client / uniform; }
  double against_guided() const { return client / guided; }
};

struct SeasonOutcome {
  SeasonScore all, after_50, after_change;
  double guided_part = 0;               ///< of all queries
  double guided_part_after_change = 0;  ///< of those
};

/// \param log  at least kSeasonQueries queries; each season takes others of them, in random order.
SeasonOutcome play_seasons(const std::vector<LoggedQuery>& log, const SeasonCase& played,
                           std::size_t seasons);

}  // namespace kinship::bench
