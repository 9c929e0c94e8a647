#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// Start of a mixture's fit: none (a full fit), or the mixture of an earlier revision of the same
/// distribution (an incremental one).
struct FitOrigin {
  std::uint64_t from_revision = 0;  ///< revision of the mixture that it started from; 0: a full fit
  std::uint64_t full_revision = 0;  ///< the last full fit before that, if incremental
  std::uint64_t paths = 0;          ///< used, of all sources
  std::uint64_t new_paths = 0;      ///< not in from_revision; all in a full fit
  std::uint64_t transferred = 0;    ///< of `paths`; configurations of the others were cached
  std::string reason;               ///< why a full fit; empty if incremental

  bool operator==(const FitOrigin&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<FitOrigin>{
    Field{"from_revision", &FitOrigin::from_revision},
    Field{"full_revision", &FitOrigin::full_revision},
    Field{"paths", &FitOrigin::paths},
    Field{"new_paths", &FitOrigin::new_paths},
    Field{"transferred", &FitOrigin::transferred},
    Field{"reason", &FitOrigin::reason, {.limit = kMaxMessageBytes}}};

/// E.g. "incremental from revision 4, 25 of 525 paths new" or "full (the first), 500 paths", and
/// the number of transferred paths if it differs from that of the new ones.
std::string describe(const FitOrigin& origin);

}  // namespace kinship
