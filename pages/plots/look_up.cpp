#include "pages/plots/look_up.hpp"

#include "proto/types/failure.hpp"

namespace kinship::plots {

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
