#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/bench/season_tasks.hpp"

/// What each query of a task costs, planned in every way that a season may choose from.
namespace kinship::bench {

/// How a query is planned.
enum class Guide {
  None,       ///< uniformly
  Good,       ///< by the mixture fitted to paths of the same task
  Turned,     ///< by the same, turned 180 degrees about the base: joint 1 + pi
  Open,       ///< as Turned, but without the gate
  Misleading  ///< by paths of which all but their ends were turned: the gate does not see it
};
inline constexpr std::array kGuides = {Guide::None, Guide::Good, Guide::Turned, Guide::Open,
                                       Guide::Misleading};
std::string_view to_text(Guide guide);

struct LoggedPlan {
  std::uint64_t checks = 0;
  bool solved = false;
  bool gate_fired = false;
};

/// One query, planned in each way.
using LoggedQuery = std::map<Guide, LoggedPlan>;

/// Records paths with uniform planning, fits the mixtures by transfer and fit of the server with
/// their default profile, and plans `queries` others in each way. Progress goes to `messages`.
std::vector<LoggedQuery> plan_queries(const SeasonTask& task, std::size_t queries,
                                      std::ostream& messages);

/// One line per plan: task,query,guide,checks,solved,gate_fired.
void write_log(const std::string& task, const std::vector<LoggedQuery>& queries,
               std::ostream& stream);

/// By task. \throws std::runtime_error for a line that is not of write_log.
std::map<std::string, std::vector<LoggedQuery>> read_log(std::istream& stream);

}  // namespace kinship::bench
