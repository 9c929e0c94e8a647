#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/values/byte_stream.hpp"
#include "server/store/values/bytes.hpp"

/// Values in columns. The codes of the enumerations are part of the schemas.
namespace kinship::store {

constexpr std::int64_t code_of(Outcome outcome) {
  return outcome == Outcome::Solved ? 1 : outcome == Outcome::Timeout ? 2 : 3;
}
constexpr Outcome outcome_of(std::int64_t code) {
  return code == 1 ? Outcome::Solved : code == 2 ? Outcome::Timeout : Outcome::Failed;
}

constexpr std::int64_t code_of(SamplingMode mode) {
  return mode == SamplingMode::Guided ? 1 : mode == SamplingMode::Control ? 2 : 3;
}
constexpr SamplingMode mode_of(std::int64_t code) {
  return code == 1   ? SamplingMode::Guided
         : code == 2 ? SamplingMode::Control
                     : SamplingMode::Uniform;
}

constexpr std::int64_t code_of(DistributionState state) { return has_mixture(state) ? 1 : 2; }
constexpr DistributionState state_of(std::int64_t code) {
  return code == 1 ? DistributionState::Ready : DistributionState::Failed;
}

/// A Digest or Uuid from a column; zeros if the column has another length (never, by CHECK).
template <typename Id>
Id id_of(Bytes column) {
  Id id;
  if (column.size() == id.bytes.size())
    std::copy(column.begin(), column.end(), id.bytes.begin());
  return id;
}

/// The blob of a pose that may be missing; bind it through blob_or_null().
inline std::optional<std::vector<std::uint8_t>> optional_pose_blob(
    const std::optional<Eigen::Isometry3d>& T_a_b) {
  if (!T_a_b)
    return std::nullopt;
  return pose_blob(*T_a_b);
}

inline std::optional<Bytes> blob_or_null(const std::optional<std::vector<std::uint8_t>>& blob) {
  if (!blob)
    return std::nullopt;
  return Bytes(*blob);
}

}  // namespace kinship::store
