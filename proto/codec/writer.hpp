#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <optional>

#include "proto/codec/arena.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/uuid.hpp"

/// Parts of values as members of messages.
namespace kinship::codec {

inline void write_digest(const Digest& digest, std::uint8_t (&bytes)[32]) {
  std::copy(digest.bytes.begin(), digest.bytes.end(), std::begin(bytes));
}

inline void write_uuid(const Uuid& uuid, std::uint8_t (&bytes)[16]) {
  std::copy(uuid.bytes.begin(), uuid.bytes.end(), std::begin(bytes));
}

/// Copies `size` numbers into a sequence.
template <typename Sequence>
void write_numbers(Arena& arena, const double* numbers, std::size_t size, Sequence& sequence) {
  arena.resize(sequence, size);
  std::copy_n(numbers, size, sequence._buffer);
}

inline void write_pose(const Eigen::Isometry3d& T, double (&numbers)[7]) {
  const PoseArray pose = to_pose_array(T);
  std::copy(pose.begin(), pose.end(), std::begin(numbers));
}

template <typename Sequence>
void write_placement(Arena& arena, const std::optional<Eigen::Isometry3d>& T, Sequence& sequence) {
  if (!T)
    return;
  const PoseArray pose = to_pose_array(*T);
  write_numbers(arena, pose.data(), pose.size(), sequence);
}

}  // namespace kinship::codec
