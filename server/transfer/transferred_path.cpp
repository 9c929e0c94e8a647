#include "server/transfer/transferred_path.hpp"

namespace kinship::transfer {

void count_pose(Eigen::Index found, inverse::NoSolution reason, TransferCounts& counts) {
  ++counts.poses;
  counts.configurations += static_cast<std::uint64_t>(found);
  switch (reason) {
    case inverse::NoSolution::None:
      ++counts.poses_solved;
      return;
    case inverse::NoSolution::OutOfReach:
      ++counts.out_of_reach;
      return;
    case inverse::NoSolution::Limits:
      ++counts.outside_limits;
      return;
    case inverse::NoSolution::NotConverged:
      ++counts.not_converged;
      return;
  }
}

void count_pose(const RandomSolutions& random, TransferCounts& counts) {
  const Eigen::Index found = random.configurations.cols();
  counts.random_configurations += static_cast<std::uint64_t>(found);
  if (!random.colliding)
    return count_pose(found, random.reason, counts);
  ++counts.poses;
  ++counts.colliding;
}

void count_filtered(const CountedFilters& filters, TransferCounts& counts) {
  counts.filter_checks = filters.checks();
  counts.self_collisions = filters.self_collisions();
  counts.scene_collisions = filters.scene_collisions();
}

}  // namespace kinship::transfer
