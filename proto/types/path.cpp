#include "proto/types/path.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "proto/types/number_text.hpp"

namespace kinship {

Path::Path(Eigen::MatrixXd waypoints) : waypoints_(std::move(waypoints)) {
  if (waypoints_.rows() < 1 || waypoints_.cols() < 2)
    throw std::invalid_argument("Path: need >= 1 joint, >= 2 waypoints");
  if (waypoints_.allFinite())
    return;
  for (Eigen::Index i = 0;; ++i)
    if (const double value = waypoints_.data()[i]; !std::isfinite(value))
      throw std::invalid_argument("waypoint " + std::to_string(i / dof() + 1) + ", joint " +
                                  std::to_string(i % dof() + 1) + ": " + number_text(value) +
                                  " is not finite");
}

}  // namespace kinship
