#include "server/transfer/transferred_path.hpp"

namespace kinship::transfer {

void TransferSummary::count(Eigen::Index found, inverse::NoSolution reason) {
  ++poses;
  configurations += static_cast<std::uint64_t>(found);
  switch (reason) {
    case inverse::NoSolution::None:
      ++poses_solved;
      return;
    case inverse::NoSolution::OutOfReach:
      ++out_of_reach;
      return;
    case inverse::NoSolution::Limits:
      ++outside_limits;
      return;
    case inverse::NoSolution::NotConverged:
      ++not_converged;
      return;
  }
}

void TransferSummary::count(const RandomSolutions& random) {
  const Eigen::Index found = random.configurations.cols();
  random_configurations += static_cast<std::uint64_t>(found);
  if (!random.colliding)
    return count(found, random.reason);
  ++poses;
  ++colliding;
}

void TransferSummary::add(const TransferSummary& other) {
  poses += other.poses;
  poses_solved += other.poses_solved;
  out_of_reach += other.out_of_reach;
  outside_limits += other.outside_limits;
  not_converged += other.not_converged;
  colliding += other.colliding;
  configurations += other.configurations;
  random_configurations += other.random_configurations;
  tracks_tried += other.tracks_tried;
  tracks_kept += other.tracks_kept;
  tracks_through += other.tracks_through;
  filter_checks += other.filter_checks;
  self_collisions += other.self_collisions;
  scene_collisions += other.scene_collisions;
}

void TransferSummary::set(const CountedFilters& filters) {
  filter_checks = filters.checks();
  self_collisions = filters.self_collisions();
  scene_collisions = filters.scene_collisions();
}

}  // namespace kinship::transfer
