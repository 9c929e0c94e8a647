#pragma once

#include <Eigen/Core>
#include <functional>

namespace kinship::planning {

/// Whether a configuration is free; counts itself. Each question is one collision check, whatever
/// answers it.
using IsFree = std::function<bool(const Eigen::VectorXd& q)>;

}  // namespace kinship::planning
