#include "server/transfer/uncovered_poses.hpp"

#include <cstddef>

namespace kinship::transfer {
namespace {

/// Poses from one end of a path to the other.
class Sweep {
 public:
  Sweep(std::size_t poses, bool backward) : poses_(poses), backward_(backward) {}

  std::size_t operator[](std::size_t i) const { return backward_ ? poses_ - 1 - i : i; }

 private:
  const std::size_t poses_;
  const bool backward_;
};

}  // namespace

std::vector<RandomSolutions> solve_uncovered(const ArmPair& pair, const PathPoses& poses,
                                             const std::vector<bool>& covered,
                                             const TransferParameters& parameters,
                                             std::uint64_t seed, CountedFilters& filters) {
  const std::size_t count = covered.size();
  std::vector<RandomSolutions> found(count);
  const auto look = [&](std::size_t pose, Patience patience) {
    found[pose] = random_solutions(pair.target_solver(), poses.T_base_transfer[pose], parameters,
                                   seed, filters, patience);
  };
  const auto is_reached = [&](std::size_t pose) {
    return found[pose].reason == inverse::NoSolution::None;
  };
  for (std::size_t pose = 0; pose < count; ++pose)
    if (!covered[pose])
      look(pose, Patience::None);
  // What a sweep finds can only matter to the pose after it: the one before was reached already.
  std::vector<bool> looked(count, false);
  for (const bool backward : {false, true}) {
    const Sweep sweep(count, backward);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t pose = sweep[i];
      if (is_reached(pose) || looked[pose] || (i > 0 && !is_reached(sweep[i - 1])))
        continue;
      look(pose, Patience::Full);
      looked[pose] = true;
    }
  }
  return found;
}

}  // namespace kinship::transfer
