#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/path.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

/// Tasks of one robot each, of which any number of similar queries can be made.
namespace kinship::bench {

/// One query: a robot among obstacles, and where it shall go.
struct SeasonQuery {
  collision::CollisionWorld world;
  Eigen::VectorXd start;  ///< dof, free
  Eigen::MatrixXd goals;  ///< dof x n, n >= 1, free
};

/// How all queries of a task are planned, guided or not.
struct SeasonPlanner {
  double step = 0.05;      ///< joint units
  double overshoot = 1.5;  ///< see planning::BirrtOptions
  std::uint64_t cap = 0;   ///< checks after which a query is given up
};

class SeasonTask {
 public:
  virtual ~SeasonTask() = default;

  /// Equal number, equal query; empty if start or goal cannot be reached in this one.
  virtual std::optional<SeasonQuery> make_query(std::uint64_t number) const = 0;

  std::string name;
  kinematics::Chain chain;
  geometry::RobotShapes shapes;
  SeasonPlanner planner;

 protected:
  SeasonTask(std::string task, const std::string& robot, const SeasonPlanner& how);
};

/// The names that make_season_task knows: planar scenes of facts known before (pocket, slot,
/// trivial) and cobots (shelf cell, open table).
std::vector<std::string> season_task_names();

/// \throws std::invalid_argument for another name.
std::unique_ptr<SeasonTask> make_season_task(const std::string& name);

}  // namespace kinship::bench
