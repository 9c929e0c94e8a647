#include "proto/types/transferability.hpp"

namespace kinship {
namespace {

using Mean = double GuideCost::*;

/// The cheapest guide with, or without, experience; null: none was planned with, or its cost is
/// unknown.
const GuideCost* cheapest(const Rehearsal& rehearsal, bool with_experience, Mean mean) {
  const GuideCost* best = nullptr;
  for (const GuideCost& cost : rehearsal.costs) {
    if (needs_experience(cost.guide) != with_experience || cost.plans == 0)
      continue;
    if (cost.*mean <= 0)
      return nullptr;
    if (best == nullptr || cost.*mean < best->*mean)
      best = &cost;
  }
  return best;
}

}  // namespace

std::optional<Worth> worth(const Rehearsal& rehearsal) {
  const GuideCost* without = cheapest(rehearsal, false, &GuideCost::mean_checks);
  const GuideCost* with = cheapest(rehearsal, true, &GuideCost::mean_checks);
  if (without == nullptr || with == nullptr)
    return std::nullopt;
  Worth found{std::nullopt, without->mean_checks / with->mean_checks, without->guide, with->guide};
  without = cheapest(rehearsal, false, &GuideCost::mean_time_s);
  with = cheapest(rehearsal, true, &GuideCost::mean_time_s);
  if (without != nullptr && with != nullptr)
    found = {without->mean_time_s / with->mean_time_s, found.by_checks, without->guide,
             with->guide};
  return found;
}

}  // namespace kinship
