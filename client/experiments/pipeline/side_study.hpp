#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/experiments/pipeline/query_runner.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// A guided cell before its distribution was fetched; a uniform one if it wishes for no profile.
struct WishedCell {
  std::string name;  ///< of the cell: "<sources>|<variant>"
  DistributionWish wish;
  double overshoot = 1;
  double share = 1;  ///< of guided samples
  guided::PlannerKind planner = guided::PlannerKind::ByProblem;
  std::optional<Guide> guide = Guide::Mixture;  ///< missing: what the server found by rehearsal
  std::optional<double> oracle_deviation = {};  ///< see Cell; wishes for no profile then
  std::optional<double> retreat_m = {};         ///< missing: as planners have it
};

/// Further cells over the test instances: what the main tables do not tell.
struct SideStudy {
  std::string name;     ///< of its log, and on the command line
  std::string purpose;  ///< for people
  std::vector<WishedCell> cells;
  /// Learning sets that are handed over once more, shortened, each under a task of its own.
  struct Shortened {
    std::string task;
    std::size_t paths = 0;
  };
  std::vector<Shortened> shortened;
  bool is_of_peers = false;  ///< planned by run_peers, not by our planner
};

/// Every side study there is for a study. Of a study along a constraint none is of peers: OMPL's
/// databases of experience know the plain space only.
std::vector<SideStudy> side_studies(const Study& study);

/// \throws Failure(NotFound) that names the side studies there are.
SideStudy find_side_study(const Study& study, std::string_view name);

/// Name of a cell of a side study.
std::string cell_name(const std::string& sources, const std::string& variant);

/// Name of a cell of the test set that plans uniformly.
std::string uniform_name(double overshoot);

inline constexpr const char* kOthers = "the others";  ///< experience of all but the robot itself
inline constexpr const char* kNobody = "nobody";      ///< no experience
inline constexpr const char* kAll = "all";            ///< and its own

}  // namespace kinship::experiments
