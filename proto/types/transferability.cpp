#include "proto/types/transferability.hpp"

#include <algorithm>

namespace kinship {
namespace {

const GuideCost* cost_of(const Rehearsal& rehearsal, Guide guide) {
  const auto cost = std::ranges::find(rehearsal.costs, guide, &GuideCost::guide);
  return cost == rehearsal.costs.end() ? nullptr : &*cost;
}

}  // namespace

std::optional<double> worth(const Rehearsal& rehearsal) {
  const GuideCost* const none = cost_of(rehearsal, Guide::None);
  const GuideCost* const best = cost_of(rehearsal, rehearsal.guide);
  if (none == nullptr || best == nullptr || none->plans == 0 || best->mean_checks <= 0)
    return std::nullopt;
  return none->mean_checks / best->mean_checks;
}

}  // namespace kinship
