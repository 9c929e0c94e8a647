#include "server/transfer/filters.hpp"

namespace kinship::transfer {

bool CountedFilters::keep(const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (!filters_.self && !filters_.scene)
    return true;
  ++checks_;
  if (filters_.self && !filters_.self(q)) {
    ++self_collisions_;
    return false;
  }
  if (filters_.scene && !filters_.scene(q)) {
    ++scene_collisions_;
    return false;
  }
  return true;
}

Eigen::MatrixXd passed(Eigen::MatrixXd configurations, CountedFilters& filters) {
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    if (!filters.keep(configurations.col(i)))
      continue;
    if (kept != i)
      configurations.col(kept) = configurations.col(i);
    ++kept;
  }
  configurations.conservativeResize(Eigen::NoChange, kept);
  return configurations;
}

}  // namespace kinship::transfer
