#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/store/store.hpp"

namespace kinship::store {

/// What is there of a robot whose paths are retired.
struct RobotRest {
  std::uint64_t attempts = 0;
  std::set<std::string> tasks;        ///< of its attempts and distributions
  std::vector<Digest> distributions;  ///< for it
};

/// Says of a robot that was taken out what became of it.
/// \param removed     has the paths that were retired.
/// \param is_deleted  with its row.
inline void complete_removal(RemovedRobot& removed, const RobotRecord& robot, RobotRest rest,
                             bool is_deleted) {
  removed.removal.robot = robot.digest;
  removed.removal.label = robot.description.label;
  removed.removal.attempts = rest.attempts;
  removed.removal.distributions = rest.distributions.size();
  removed.removal.is_deleted = is_deleted;
  removed.tasks.assign(rest.tasks.begin(), rest.tasks.end());
  removed.distributions = std::move(rest.distributions);
}

}  // namespace kinship::store
