#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>

#include "client/planning/configuration_sampler.hpp"

namespace kinship::planning {

/// Whether a configuration is free; counts itself.
using IsFree = std::function<bool(const Eigen::VectorXd& q)>;

struct BirrtOptions {
  double step = 0.1;       ///< between checked configurations, joint units
  double overshoot = 1.5;  ///< extend towards q_near + f (q_sample - q_near), clamped to the limits
  std::uint64_t max_checks = 100'000;
  std::chrono::duration<double> time_limit{10};
};

struct PlanSummary {
  std::optional<Eigen::MatrixXd> waypoints;  ///< dof x n, at most `step` apart; absent if unsolved
  std::uint64_t collision_checks = 0;
  std::uint64_t iterations = 0;
  double planning_time_s = 0;
  std::string reason;  ///< why unsolved: "start collides", "every goal collides", "checks", "time"
};

/// Bi-directional RRT with greedy extension of both trees, in the style of CBiRRT2 without
/// constraints. Every goal configuration is a root of the goal tree. Equal seed, equal path.
/// Source: Berenson, Srinivasa, Kuffner, Task Space Regions (2011), algorithm 1.
PlanSummary plan_birrt(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const IsFree& is_free, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator);

}  // namespace kinship::planning
