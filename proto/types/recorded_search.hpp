#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kinship {

/// Growth of the trees of one search, for viewers. Node 0 is the start; every other node without a
/// parent is a goal.
struct RecordedSearch {
  std::string name;                   ///< of the problem
  Eigen::MatrixXd nodes;              ///< dof x n, in the order of insertion, joint units
  std::vector<std::int64_t> parents;  ///< n: an earlier node, or -1
  std::vector<std::uint64_t> checks;  ///< n: collision checks up to then
  std::vector<std::int64_t> path;     ///< nodes from the start to a goal; empty if unsolved
};

inline constexpr std::size_t kMaxRecordedNodes = 50'000;  ///< of a search; later ones are left out

}  // namespace kinship
