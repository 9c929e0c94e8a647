#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/chain.hpp"

/// Contacts of a robot's links in random configurations, with counts.
namespace kinship::collision {

struct PairSamplingOptions {
  std::uint64_t samples = 10'000;  ///< configurations, uniform within the limits
  std::uint64_t seed = 0;
  /// Called now and then with the finished part, 0 to 1.
  std::function<void(double)> progress = [](double) {};
};

/// Two links with solids that a joint of the chain moves apart, or that are parent and child.
struct SampledPair {
  int link_a = 0, link_b = 0;    ///< first < second
  bool is_adjacent = false;      ///< parent and child, also through links without solids
  std::uint64_t touched = 0;     ///< number of samples
  bool touches_at_zero = false;  ///< with all joints at 0, moved into their limits
};

/// All such pairs of a robot, also those that its description excludes; ordered by links. Seeded:
/// equal input, equal answers.
/// \throws Failure(InvalidInput) as RobotSolids' constructor.
std::vector<SampledPair> sample_pairs(const kinematics::Chain& chain,
                                      const geometry::RobotShapes& shapes,
                                      const PairSamplingOptions& options = {});

}  // namespace kinship::collision
