#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "proto/types/problem.hpp"
#include "proto/types/recorded_search.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

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
