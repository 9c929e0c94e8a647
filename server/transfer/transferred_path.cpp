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

void TransferSummary::add(const TransferSummary& other) {
  poses += other.poses;
  poses_solved += other.poses_solved;
  out_of_reach += other.out_of_reach;
  outside_limits += other.outside_limits;
  not_converged += other.not_converged;
  configurations += other.configurations;
}

}  // namespace kinship::transfer
