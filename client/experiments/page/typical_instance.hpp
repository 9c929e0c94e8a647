#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/problem.hpp"
#include "proto/types/recorded_search.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

/// An instance that both samplings solved, and how typical it is.
struct TypicalInstance {
  std::string problem;
  std::uint64_t uniform_checks = 0, guided_checks = 0;
  double ratio = 0;            ///< of its checks, uniform / guided
  double median_ratio = 0;     ///< of all candidates
  std::size_t candidates = 0;  ///< instances that both solved
};

/// The instance whose ratio is nearest the median of the ratios, the first of equals.
/// \return empty if none was solved by both.
std::optional<TypicalInstance> find_typical(const std::vector<ProblemResult>& uniform,
                                            const std::vector<ProblemResult>& guided);

/// A search by where the hand was: what a page draws of it.
struct GrownSearch {
  Eigen::Matrix3Xd hand;  ///< of each node, in the task frame, m
  std::vector<std::int64_t> parents, path;
  std::vector<std::uint64_t> checks;
};

/// \throws Failure(InvalidInput) if the search is of a robot with another number of joints.
GrownSearch grown(const models::LoadedRobot& robot, const Problem& problem,
                  const RecordedSearch& search);

}  // namespace kinship::experiments
