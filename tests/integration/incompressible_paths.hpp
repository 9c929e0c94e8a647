#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <random>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"

namespace kinship::test {

/// Registers a panda and reports paths of it, some 430 kB each, that cannot be compressed.
inline void report_incompressible_paths(link::Client& client, std::size_t paths) {
  const Digest panda = client.register_robot(model_description("panda")).value_or_throw().robot;
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> joint(-0.5, 0.5);
  for (std::size_t i = 0; i < paths; ++i) {
    Attempt attempt = panda_attempt(panda, "sweep", 1);
    Eigen::MatrixXd waypoints =
        Eigen::MatrixXd::NullaryExpr(7, 8000, [&] { return joint(generator); });
    waypoints.row(3).array() -= 1.5;  // within the limits
    waypoints.row(5).array() += 1.5;
    attempt.path = Path(waypoints);
    client.report(attempt);
  }
  const link::Client::OutboxState state = client.flush(std::chrono::seconds(60));
  ASSERT_EQ(state.accepted, paths) << state.problem;
}

}  // namespace kinship::test
