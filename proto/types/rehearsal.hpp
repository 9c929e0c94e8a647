#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// Guide of a query: any of four, or none. The retreat backs out along the palm first and needs no
/// experience; ways are stored pose paths, moved onto the query; the mixture is the distribution's;
/// recall tries whole stored paths before the search, which the others guide. As bits: 1, 2, 4, 8.
enum class Guide {
  None,
  Retreat,
  Ways,
  RetreatWays,
  Mixture,
  RetreatMixture,
  WaysMixture,
  RetreatWaysMixture,
  Recall,
  RecallRetreat,
  RecallWays,
  RecallRetreatWays,
  RecallMixture,
  RecallRetreatMixture,
  RecallWaysMixture,
  All,
};

constexpr bool has_retreat(Guide guide) { return (static_cast<unsigned>(guide) & 1U) != 0; }
constexpr bool has_ways(Guide guide) { return (static_cast<unsigned>(guide) & 2U) != 0; }
constexpr bool has_mixture(Guide guide) { return (static_cast<unsigned>(guide) & 4U) != 0; }
constexpr bool has_recall(Guide guide) { return (static_cast<unsigned>(guide) & 8U) != 0; }

constexpr Guide with_recall(Guide guide) {
  return static_cast<Guide>(static_cast<unsigned>(guide) | 8U);
}
/// The guide of the search alone.
constexpr Guide without_recall(Guide guide) {
  return static_cast<Guide>(static_cast<unsigned>(guide) & 7U);
}
/// Whether it uses anything but the retreat.
constexpr bool needs_experience(Guide guide) { return (static_cast<unsigned>(guide) & ~1U) != 0; }

/// Cost of planning recorded queries again with one guide.
struct GuideCost {
  Guide guide = Guide::None;
  std::uint64_t plans = 0;   ///< a guide dropped early has fewer than the others
  std::uint64_t solved = 0;  ///< plans solved within the limit of a rehearsal
  double mean_checks = 0;    ///< of all plans, including the checks of unsolved ones
  double median_checks = 0;
  double mean_time_s = 0;  ///< processor time of all plans: guidance, tracks, search; 0: unknown

  bool operator==(const GuideCost&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<GuideCost>{
    Field{"guide", &GuideCost::guide, {.max = static_cast<double>(Guide::All)}},
    Field{"plans", &GuideCost::plans},
    Field{"solved", &GuideCost::solved},
    Field{"mean_checks", &GuideCost::mean_checks, {.min = 0}},
    Field{"median_checks", &GuideCost::median_checks, {.min = 0}},
    Field{"mean_time_s", &GuideCost::mean_time_s, {.min = 0}}};

inline constexpr std::size_t kMaxGuideCosts = 16;

/// Result of planning a task's recorded queries again at the server: for one robot at one
/// placement, with the guidance it would get, each query without the path that once answered it.
struct Rehearsal {
  Guide guide = Guide::All;     ///< the one to use
  bool is_complete = false;     ///< false: it continues
  std::uint64_t queries = 0;    ///< recorded ones planned again
  std::uint64_t left_out = 0;   ///< start or goal infeasible for this robot at its placement
  double processor_time_s = 0;  ///< of the server
  std::vector<GuideCost> costs = {};
  std::string message = {};  ///< why there is no result, for people

  bool operator==(const Rehearsal&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<Rehearsal>{
    Field{"guide", &Rehearsal::guide, {.max = static_cast<double>(Guide::All)}},
    Field{"is_complete", &Rehearsal::is_complete},
    Field{"queries", &Rehearsal::queries},
    Field{"left_out", &Rehearsal::left_out},
    Field{"processor_time_s", &Rehearsal::processor_time_s, {.min = 0}},
    Field{"costs", &Rehearsal::costs, {.limit = kMaxGuideCosts}},
    Field{"message", &Rehearsal::message, {.limit = kMaxMessageBytes}}};

}  // namespace kinship
