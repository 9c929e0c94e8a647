#pragma once

#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// Weighting of the experience of several robots in a fit.
enum class Weighting {
  Sources,  ///< every source robot equally; the target's own at least half from 30 paths on
  Paths     ///< by number of paths, as in the paper
};

/// The part of a task's experience that a distribution is made of.
struct Selection {
  std::vector<Digest> sources;         ///< source robots, ascending and distinct; empty: all
  std::optional<Weighting> weighting;  ///< missing: the profile's
  std::int64_t since_ms = 0;           ///< paths received at or after, Unix time, UTC; 0: all

  bool operator==(const Selection&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<Selection>{
    Field{"sources", &Selection::sources, {.limit = kMaxSelectedSources, .may_be_missing = true}},
    Field{"weighting", &Selection::weighting},
    Field{"since_ms", &Selection::since_ms, {.min = 0, .may_be_missing = true}}};

}  // namespace kinship
