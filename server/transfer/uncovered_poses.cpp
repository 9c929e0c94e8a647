#include "server/transfer/uncovered_poses.hpp"

#include <cstddef>
#include <utility>

#include "proto/types/stopped.hpp"
#include "robots/inverse/joint_space.hpp"

namespace kinship::transfer {
namespace {

constexpr std::uint64_t kSecondSeed = 0x5bd1e995;  // added for the second search of a pose

/// Appends columns of `more` that are at least `min_distance` from all before, up to `most`.
void append_distinct(const Eigen::MatrixXd& more, const inverse::JointSpace& target,
                     const TransferParameters& parameters, Eigen::MatrixXd& kept) {
  for (Eigen::Index i = 0; i < more.cols() && kept.cols() < parameters.max_solutions; ++i) {
    bool distinct = true;
    for (Eigen::Index j = 0; j < kept.cols() && distinct; ++j)
      distinct = target.squared_distance(more.col(i).data(), kept.col(j).data()) >=
                 parameters.min_distance * parameters.min_distance;
    if (!distinct)
      continue;
    kept.conservativeResize(Eigen::NoChange, kept.cols() + 1);
    kept.rightCols(1) = more.col(i);
  }
}

}  // namespace

RandomSolutions random_solutions(const inverse::Solver& target,
                                 const Eigen::Isometry3d& T_base_transfer,
                                 const TransferParameters& parameters, std::uint64_t seed,
                                 CountedFilters& filters, bool exhaustive) {
  const Eigen::Isometry3d T_base_tip = T_base_transfer * target.T_tip_transfer().inverse();
  inverse::InverseOptions options{.max_solutions = parameters.max_solutions,
                                  .min_distance = parameters.min_distance,
                                  .seed = seed,
                                  .exhaustive = exhaustive};
  inverse::InverseSolutions first = target.solve(T_base_tip, options);
  const Eigen::Index found = first.configurations.cols();
  RandomSolutions result{passed(std::move(first.configurations), filters), first.reason, false};
  if (result.configurations.cols() == found)
    return result;
  if (parameters.max_solutions > 0) {
    options.seed += kSecondSeed;
    append_distinct(passed(target.solve(T_base_tip, options).configurations, filters),
                    target.space(), parameters, result.configurations);
  }
  result.colliding = result.configurations.cols() == 0;
  return result;
}

std::vector<RandomSolutions> solve_uncovered(const ArmPair& pair, const PathPoses& poses,
                                             const std::vector<bool>& covered,
                                             const TransferParameters& parameters,
                                             const Search& search, CountedFilters& filters) {
  const std::size_t count = covered.size();
  std::vector<RandomSolutions> found(count);
  const auto look = [&](std::size_t pose, bool exhaustive) {
    throw_if_stopped(search.stop);
    found[pose] = random_solutions(pair.target_solver(), poses.T_base_transfer[pose], parameters,
                                   search.seed, filters, exhaustive);
  };
  const auto is_reached = [&](std::size_t pose) {
    return found[pose].reason == inverse::NoSolution::None;
  };
  for (std::size_t pose = 0; pose < count; ++pose)
    if (!covered[pose])
      look(pose, false);
  // The find of a sweep only matters to the pose after it: the one before was reached already.
  std::vector<bool> looked(count, false);
  for (const bool backward : {false, true})
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t pose = backward ? count - 1 - i : i;
      const std::size_t before = backward ? pose + 1 : pose - 1;
      if (is_reached(pose) || looked[pose] || (i > 0 && !is_reached(before)))
        continue;
      look(pose, true);
      looked[pose] = true;
    }
  return found;
}

}  // namespace kinship::transfer
