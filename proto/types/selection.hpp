#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/digest.hpp"

namespace kinship {

/// How the experience of several robots is weighed against each other in a fit.
enum class Weighting {
  Sources,  ///< every source robot the same; the target's own at least half from 30 paths on
  Paths     ///< by number of paths, as in the paper
};

/// Which part of a task's experience a distribution is made of.
struct Selection {
  std::vector<Digest> sources;         ///< source robots, ascending and distinct; empty: all
  std::optional<Weighting> weighting;  ///< missing: the profile's
  std::int64_t since_ms = 0;           ///< paths received at or after, Unix time, UTC; 0: all

  bool operator==(const Selection&) const = default;
};

}  // namespace kinship
