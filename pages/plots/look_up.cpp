#include "pages/plots/look_up.hpp"

#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::plots {

std::vector<PathSummary> newest_paths(const LookUp& look_up, const std::string& task,
                                      const std::optional<Digest>& robot, std::size_t most) {
  std::vector<PathSummary> paths;
  std::size_t in_use = 0;
  look_up.for_each_path(task, robot, [&](PathSummary path) {
    if (path.retired_ms == 0)
      ++in_use;
    paths.push_back(std::move(path));
    return in_use < most;
  });
  return paths;
}

const DrawnRobot* DrawnRobots::find(const Digest& robot) {
  const auto [known, is_new] = robots_.try_emplace(robot);
  if (is_new) {
    try {
      auto drawn = std::make_unique<const DrawnRobot>(drawn_robot(look_up_.robot(robot)));
      if (drawn->robot.chain.digest() == robot)
        known->second = std::move(drawn);
    } catch (const Failure&) {  // its paths are left out and counted
    }
  }
  return known->second.get();
}

}  // namespace kinship::plots
