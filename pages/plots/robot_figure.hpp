#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <string>

#include "pages/plots/drawn_robot.hpp"
#include "proto/types/summaries.hpp"

namespace kinship::plots {

/// A registered robot whose joints a reader moves.
struct RobotFigure {
  RobotSummary summary;
  DrawnRobot drawn;
  Eigen::VectorXd shown;       ///< dof: the configuration that is shown first
  bool touches_itself = true;  ///< whether its known shapes touch there
};

/// Shows all joints at 0, moved into their limits, or the first configuration in which the known
/// shapes do not touch: the middle of the limits, then random ones (seeded).
/// \throws Failure as drawn_robot.
RobotFigure robot_figure(const RobotSummary& summary, const RobotDescription& description,
                         const std::vector<StoredMesh>& contents = {});

std::string to_json(const RobotFigure& figure);

}  // namespace kinship::plots
