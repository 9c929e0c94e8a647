#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "client/experiments/pipeline/experience_server.hpp"
#include "client/experiments/pipeline/fleet.hpp"
#include "client/experiments/pipeline/query_log.hpp"

namespace kinship::experiments {

/// One way in which a robot plans the instances.
struct Cell {
  std::size_t robot = 0;  ///< index into the fleet
  std::string name;       ///< unique among the robot's cells; in QueryKey::guidance
  guided::PlanSettings settings;
  std::optional<guided::Guidance> guidance;  ///< missing: uniform
  /// Guided by an answer to each query itself (oracle.hpp), so far about it; joint units.
  std::optional<double> oracle_deviation = {};
};

/// Sets what a cell is guided by.
/// \param guide  missing: what the server found by rehearsal, as `kinship-plan --rehearsed` has it.
/// \param share  of guided samples; 0 to 1.
/// \return       whether there is what the guide needs: without a mixture, or without a stored way,
///               a cell cannot be.
bool guide_by(std::optional<Guide> guide, const StudyMember& member, const Fetched& fetched,
              double share, Cell& cell);

/// Which instances are planned, and how often.
struct QueryPlan {
  std::uint64_t seed = 0;  ///< of the instances
  std::uint32_t instances = 0;
  std::uint32_t seeds = 1;  ///< planned under each instance's own seed + 0, + 1, ...
  int threads = 1;
  std::function<void()> answered;  ///< called after each query, from any thread; may be empty
};

/// Plans what is not in the log yet. An instance belongs to one thread, which plans it with all
/// cells of the robot in turn, seed after seed: whatever disturbs the machine disturbs them alike.
void run_queries(const std::vector<StudyMember>& fleet, const std::vector<Cell>& cells,
                 const QueryPlan& plan, QueryLog& log);

}  // namespace kinship::experiments
