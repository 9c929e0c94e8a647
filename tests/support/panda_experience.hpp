#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "proto/types/attempt.hpp"

namespace kinship::test {

/// A sweep of the Panda's hand from left to right in front of it, a little different for every
/// seed; well within reach of a UR10e that stands at the same place.
inline Path panda_sweep(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  Eigen::MatrixXd waypoints(7, 4);
  const Eigen::VectorXd ready{{0, -0.785, 0, -2.356, 0, 1.571, 0.785}};
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i) {
    waypoints.col(i) = ready;
    waypoints(0, i) += -0.9 + 0.6 * static_cast<double>(i);
    waypoints(3, i) += i % 2 == 0 ? 0.2 : -0.2;
    for (Eigen::Index j = 0; j < 7; ++j)
      waypoints(j, i) += noise(generator);
  }
  return Path(waypoints);
}

/// That sweep as the report of a planner.
inline Attempt panda_attempt(const Digest& panda, const std::string& task, std::uint64_t seed) {
  Attempt attempt;
  attempt.report_uuid = Uuid::random();
  attempt.robot = panda;
  attempt.machine = "test";
  attempt.task = task;
  attempt.record.outcome = Outcome::Solved;
  attempt.record.planner = "birrt";
  attempt.record.planning_time_s = 0.5;
  attempt.record.collision_checks = 1000;
  attempt.record.time_limit_s = 10;
  attempt.path = panda_sweep(seed);
  return attempt;
}

}  // namespace kinship::test
