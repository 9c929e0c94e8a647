#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/robot_solids.hpp"
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

/// Number of random configurations, and in how many of them two bodies must touch to count as
/// always touching.
struct TouchSamples {
  int count = 0;
  int least = 0;
};

/// The samples by which a robot's links are excluded from checks if no pairs are named.
inline constexpr TouchSamples kLinkSamples{.count = 200, .least = 190};

/// The pairs of a robot's links that always touch: in at least samples.least of samples.count
/// random configurations within the limits. Seeded: equal input, equal answers.
/// \param robot  its unchecked pairs of links are left out.
LinkPairs links_always_touching(const RobotSolids::Parts& robot, const TouchSamples& samples);

/// The pairs of names that always touch in the same sense, among links, attachments and obstacles.
/// \throws Failure(InvalidInput) as CollisionWorld's constructor.
std::set<std::pair<std::string, std::string>> always_touching(const RobotSolids& robot,
                                                              const Surroundings& surroundings,
                                                              const TouchSamples& samples);

}  // namespace kinship::collision
